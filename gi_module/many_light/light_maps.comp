#version 460
#extension GL_GOOGLE_include_directive : require
// Adds and subtracts unshadowed samples (VPLs) in light maps, one work group per job. Each contribution is rounded to
// fixed point on its own, so that it can be subtracted again exactly.
#include "gi_module/many_light/light_maps_shared.h"
#include "gi_module/transport/light_row_shared.h"

layout(local_size_x = 64) in;
layout(set = 0, binding = 0) readonly buffer Jobs { LightMapJob jobs[]; };
layout(set = 0, binding = 1) readonly buffer Changes { uint changes[]; };
layout(set = 0, binding = 2) readonly buffer Lights { LightRow lights[]; };
layout(set = 0, binding = 3) buffer Texels { ivec4 texels[]; };
layout(push_constant) uniform Constants { LightMapConstants constants; };

// Surface samples only; the same formula as in shadowed_light.glsl.
vec3 unshadowed(LightRow light, vec3 position, vec3 normal) {
    const vec3 v = position - light.position_bound.xyz;
    const float inverse = 1.0 / max(dot(v, v), 1e-12);
    const float term = max(dot(light.normal_offset.xyz, v), 0.0) * max(-dot(normal, v), 0.0) * inverse * inverse;
    return light.intensity_slot.rgb * min(term, light.position_bound.w);
}

void main() {
    const uint number = gl_WorkGroupID.y * constants.row_length + gl_WorkGroupID.x;
    if (number >= constants.jobs)
        return;
    const LightMapJob job = jobs[number];
    const uint end = job.first + job.count;
    uint i = job.first + gl_LocalInvocationID.x;
    if (i < end) do { // tested at its end: see light.comp
        const vec2 place = vec2(i % job.columns, i / job.columns) / vec2(job.columns - 1u, job.rows - 1u);
        const vec3 position = job.corner.xyz + job.u_edge.xyz * place.x + job.v_edge.xyz * place.y;
        ivec4 sum = job.clear != 0u ? ivec4(0) : texels[job.first_texel + i];
        for (uint c = 0; c < job.change_count; ++c) {
            const uint change = changes[job.first_change + c];
            const vec3 light = unshadowed(lights[change & light_map_sample_mask], position, job.normal.xyz);
            const ivec3 steps = ivec3(light * constants.fixed_point + 0.5);
            sum.rgb += (change & light_map_subtract) != 0u ? -steps : steps;
        }
        texels[job.first_texel + i] = sum;
        i += 64u;
    } while (i < end);
}

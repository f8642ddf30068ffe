#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// Adds, replaces and subtracts unshadowed samples (VPLs) in light maps. One work group per job and several texels per
// invocation, which share each sample's loads. Each contribution is rounded to fixed point on its own, so that it can
// be subtracted again exactly.
#include "gi_module/many_light/light_maps_shared.h"
#include "gi_module/transport/light_row_shared.h"

const uint lanes = 8u, texels_per_invocation = 8u;

layout(local_size_x = 8) in;
layout(set = 0, binding = 0) readonly buffer Jobs { LightMapJob jobs[]; };
layout(set = 0, binding = 1) readonly buffer Changes { uint changes[]; };
layout(set = 0, binding = 2) readonly buffer Lights { LightRow lights[]; };
layout(set = 0, binding = 3) buffer Texels { ivec4 texels[]; };
layout(push_constant) uniform Constants { LightMapConstants constants; };

// A change as all texels need it. `before`: the intensity that is replaced, or 0.
struct Change {
    vec4 position_bound;
    vec3 axis, intensity, before;
    int direction;
};

Change change_at(uint number) {
    const uint change = changes[number];
    const uint row = change & light_map_sample_mask;
    Change result = Change(lights[row].position_bound, lights[row].normal_offset.xyz, lights[row].intensity_slot.rgb,
                           vec3(0.0), (change & light_map_subtract) != 0u ? -1 : 1);
    if ((change & light_map_replace) != 0u)
        result.before = lights[row + 1u].intensity_slot.rgb;
    return result;
}

// Of an intensity, what arrives. Surface samples only; the same formula as in shadowed_light.glsl.
float unshadowed(Change light, vec3 position, vec3 normal) {
    const vec3 v = position - light.position_bound.xyz;
    const float inverse = 1.0 / max(dot(v, v), 1e-12);
    const float term = max(dot(light.axis, v), 0.0) * max(-dot(normal, v), 0.0) * inverse * inverse;
    return min(term, light.position_bound.w);
}

ivec3 steps_of(vec3 intensity, float factor) {
    precise vec3 steps = intensity * factor * constants.fixed_point; // the same wherever it is subtracted again
    return ivec3(steps + 0.5);
}

ivec3 change_of(Change change, vec3 position, vec3 normal) {
    const float factor = unshadowed(change, position, normal);
    return steps_of(change.intensity, factor) * change.direction - steps_of(change.before, factor);
}

vec3 position_at(LightMapJob job, uint i) {
    const vec2 place = vec2(i % job.columns, i / job.columns) / vec2(job.columns - 1u, job.rows - 1u);
    return job.corner.xyz + job.u_edge.xyz * place.x + job.v_edge.xyz * place.y;
}

ivec3 sum_before(LightMapJob job, uint i) {
    return job.clear != 0u ? ivec3(0) : texels[job.first_texel + i].xyz;
}

void sum_many(LightMapJob job, uint begin, uint end) {
    vec3 position[texels_per_invocation];
    ivec3 sum[texels_per_invocation];
    [[unroll]] for (uint k = 0; k < texels_per_invocation; ++k) {
        const uint i = min(begin + k * lanes + gl_LocalInvocationID.x, end - 1u);
        position[k] = position_at(job, i);
        sum[k] = sum_before(job, i);
    }
    for (uint c = 0; c < job.change_count; ++c) {
        const Change change = change_at(job.first_change + c);
        [[unroll]] for (uint k = 0; k < texels_per_invocation; ++k)
            sum[k] += change_of(change, position[k], job.normal.xyz);
    }
    [[unroll]] for (uint k = 0; k < texels_per_invocation; ++k) {
        const uint i = begin + k * lanes + gl_LocalInvocationID.x;
        if (i < end)
            texels[job.first_texel + i] = ivec4(sum[k], 0);
    }
}

// The same for as many texels as there are lanes: what is left of a map.
void sum_few(LightMapJob job, uint begin, uint end) {
    const uint i = min(begin + gl_LocalInvocationID.x, end - 1u);
    const vec3 position = position_at(job, i);
    ivec3 sum = sum_before(job, i);
    for (uint c = 0; c < job.change_count; ++c)
        sum += change_of(change_at(job.first_change + c), position, job.normal.xyz);
    if (begin + gl_LocalInvocationID.x < end)
        texels[job.first_texel + i] = ivec4(sum, 0);
}

void main() {
    const uint number = gl_WorkGroupID.y * constants.row_length + gl_WorkGroupID.x;
    if (number >= constants.jobs)
        return;
    const LightMapJob job = jobs[number];
    const uint end = job.first + job.count;
    uint begin = job.first;
    if (begin + lanes < end) do { // tested at its end: see light.comp
        sum_many(job, begin, end);
        begin += lanes * texels_per_invocation;
    } while (begin + lanes < end);
    if (begin < end) do {
        sum_few(job, begin, end);
        begin += lanes;
    } while (begin < end);
}

#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// Adds and subtracts samples (VPLs) in baked light, shadow-tested against static geometry where they are partially
// occluded. One work group per job and several texels per invocation, which share each sample's loads. Contributions
// are rounded one by one, as in light_maps.comp.
#include "engine/core/octahedral.h"
#include "gi_module/charts/curved_charts_shared.h"
#include "gi_module/many_light/light_maps_shared.h"
#include "gi_module/shadows/octahedral_map.h"
#include "gi_module/transport/light_row_shared.h"

layout(constant_id = 0) const uint filtered = 0;
layout(constant_id = 1) const uint map_bits = 16;
const uint light_class = light_class_surface;
const uint maps = maps_texel_buffer;
const uint stale_maps = 0, simplified_movers = 0;
const uint lanes = 8u, texels_per_invocation = 8u;

layout(local_size_x = 8) in;
layout(set = 0, binding = 0) uniform usamplerBuffer jobs; // LightMapJobs
layout(set = 0, binding = 1) readonly buffer Changes { uint changes[]; };
layout(set = 0, binding = 2) uniform usamplerBuffer lights; // LightRows
layout(set = 0, binding = 3) uniform usamplerBuffer static_map_words;
layout(set = 0, binding = 4) buffer Sums { ivec4 sums[]; };
layout(set = 0, binding = 5) readonly buffer Points { CurvedPoint points[]; };
layout(push_constant) uniform Constants { LightMapConstants constants; };

#include "gi_module/shadows/map_words.glsl"

float map_side() { return float(constants.map_resolution); }
float map_value(uint slot, ivec2 texel) {
    const int side = int(constants.map_resolution);
    const int place = (int(slot) * side + texel.y) * side + texel.x;
    return value_in_word(texelFetch(static_map_words, map_word(place)).r, place);
}
#include "gi_module/shadows/shadowed_light.glsl"

#include "gi_module/many_light/light_map_job.glsl"

LightRow light_at(uint number) {
    const int first = int(number) * 5;
    return LightRow(uintBitsToFloat(texelFetch(lights, first)), uintBitsToFloat(texelFetch(lights, first + 1)),
                    uintBitsToFloat(texelFetch(lights, first + 2)), uintBitsToFloat(texelFetch(lights, first + 3)),
                    uintBitsToFloat(texelFetch(lights, first + 4)));
}

Pixel pixel_at(LightMapJob job, uint i) {
    Pixel pixel;
    pixel.on_mover = 0.0;
    if (job.first_point != no_points) {
        const CurvedPoint point = points[job.first_point + i];
        pixel.position = point.position.xyz;
        pixel.normal = unpack_normal(point.normal);
        pixel.geometric_normal = unpack_normal(point.geometric_normal);
    } else {
        const vec2 last = vec2(job.columns - 1u, job.rows - 1u);
        const vec2 place = clamp(vec2(i % job.columns, i / job.columns), vec2(constants.inset), last - constants.inset) / last;
        pixel.position = job.corner.xyz + job.u_edge.xyz * place.x + job.v_edge.xyz * place.y;
        pixel.normal = pixel.geometric_normal = job.normal.xyz;
    }
    return pixel;
}

ivec3 steps_of(vec3 intensity, float factor) {
    precise vec3 steps = intensity * factor * constants.fixed_point; // the same wherever it is subtracted again
    return ivec3(steps + 0.5);
}

// What a change adds to a texel: light in fixed point. `before`: the intensity that is replaced, or 0.
ivec3 change_of(uint change, LightRow light, vec3 before, Pixel texel) {
    const float untested = (change & light_map_test) != 0u ? 0.0 : 1.0;
    const int direction = (change & light_map_subtract) != 0u ? -1 : 1;
    const LightFactor factor = light_factor(light, texel, true);
    const float share = factor.unshadowed * max(factor.visibility, untested);
    return steps_of(light.intensity_slot.rgb, share) * direction - steps_of(before, share);
}

vec3 intensity_before(uint change) {
    const int row = int(change & light_map_sample_mask) + 1;
    return (change & light_map_replace) != 0u ? uintBitsToFloat(texelFetch(lights, row * 5 + 2).rgb) : vec3(0.0);
}

ivec3 sum_before(LightMapJob job, uint i) {
    return job.clear != 0u ? ivec3(0) : sums[job.first_texel + i].xyz;
}

void sum_many(LightMapJob job, uint begin, uint end) {
    Pixel texel[texels_per_invocation];
    ivec3 sum[texels_per_invocation];
    [[unroll]] for (uint k = 0; k < texels_per_invocation; ++k) {
        const uint i = min(begin + k * lanes + gl_LocalInvocationID.x, end - 1u);
        texel[k] = pixel_at(job, i);
        sum[k] = sum_before(job, i);
    }
    for (uint c = 0; c < job.change_count; ++c) {
        const uint change = changes[job.first_change + c];
        const LightRow light = light_at(change & light_map_sample_mask);
        const vec3 before = intensity_before(change);
        [[unroll]] for (uint k = 0; k < texels_per_invocation; ++k)
            sum[k] += change_of(change, light, before, texel[k]);
    }
    [[unroll]] for (uint k = 0; k < texels_per_invocation; ++k) {
        const uint i = begin + k * lanes + gl_LocalInvocationID.x;
        if (i < end)
            sums[job.first_texel + i] = ivec4(sum[k], 0);
    }
}

// The same for as many texels as there are lanes: most of what small surfaces have.
void sum_few(LightMapJob job, uint begin, uint end) {
    const uint i = min(begin + gl_LocalInvocationID.x, end - 1u);
    const Pixel texel = pixel_at(job, i);
    ivec3 sum = sum_before(job, i);
    for (uint c = 0; c < job.change_count; ++c) {
        const uint change = changes[job.first_change + c];
        sum += change_of(change, light_at(change & light_map_sample_mask), intensity_before(change), texel);
    }
    if (begin + gl_LocalInvocationID.x < end)
        sums[job.first_texel + i] = ivec4(sum, 0);
}

void main() {
    const uint number = gl_WorkGroupID.y * constants.row_length + gl_WorkGroupID.x;
    if (number >= constants.jobs)
        return;
    const LightMapJob job = job_at(number);
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

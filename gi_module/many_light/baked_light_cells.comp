#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// Converts baked light to the format that pixels read, and marks rough cells: those between four texels that cannot be
// interpolated.
#include "gi_module/charts/curved_charts_shared.h"
#include "gi_module/many_light/light_maps_shared.h"

layout(local_size_x = 64) in;
layout(set = 0, binding = 0) uniform usamplerBuffer jobs; // LightMapJobs
layout(set = 0, binding = 1) uniform isamplerBuffer sums;
layout(set = 0, binding = 2) writeonly buffer Texels { uvec2 texels[]; };
layout(set = 0, binding = 3) readonly buffer Points { CurvedPoint points[]; };
layout(push_constant) uniform Constants { LightMapConstants constants; };

#include "gi_module/many_light/light_map_job.glsl"

const float largest_half = 65504.0;

// Of places beside the map, something that is not looked at.
vec3 light_at(LightMapJob job, ivec2 texel) {
    const int place = clamp(texel.y * int(job.columns) + texel.x, 0, int(job.columns * job.rows) - 1);
    return vec3(texelFetch(sums, int(job.first_texel) + place).xyz);
}

// Whether a texel is too far off the line between its neighbours, relative to the brightest of the three.
bool bends(vec3 before, vec3 here, vec3 after) {
    const vec3 most = max(max(before, here), after);
    return any(greaterThan(abs(before - 2.0 * here + after), constants.roughness_limit * most + 2.0));
}

bool differ(vec3 a, vec3 b) {
    return any(greaterThan(abs(a - b), constants.roughness_limit * max(a, b) + 2.0));
}

// Whether the texel is in the map and, in a chart, on the surface.
bool exists(LightMapJob job, ivec2 texel) {
    if (any(lessThan(texel, ivec2(0))) || any(greaterThanEqual(texel, ivec2(job.columns, job.rows))))
        return false;
    return job.first_point == no_points || points[job.first_point + uint(texel.y) * job.columns + uint(texel.x)].exists != 0u;
}

// From the twelve texels that its corners and their neighbours are: of a square of sixteen, all but its corners.
bool is_rough(LightMapJob job, ivec2 cell) {
    vec3 light[16];
    bool there[16];
    [[unroll]] for (int i = 0; i < 16; ++i) {
        const bool is_corner = (i & 3) % 3 == 0 && (i >> 2) % 3 == 0;
        const ivec2 texel = cell - 1 + ivec2(i & 3, i >> 2);
        light[i] = is_corner ? vec3(0.0) : light_at(job, texel);
        there[i] = !is_corner && exists(job, texel);
    }
    bool rough = false;
    [[unroll]] for (int i = 0; i < 4; ++i) {
        const int here = 5 + (i & 1) + 4 * (i >> 1);
        [[unroll]] for (int axis = 0; axis < 2; ++axis) {
            const int step = axis == 0 ? 1 : 4;
            const bool before = there[here - step], after = there[here + step];
            // The rim of a curved surface, or the only cell of a patch along this axis.
            const bool rim = job.first_point != no_points || (axis == 0 ? job.columns : job.rows) == 2u;
            rough = rough || (before && after ? bends(light[here - step], light[here], light[here + step])
                                              : rim && differ(before ? light[here - step] : light[here + step], light[here]));
        }
    }
    return rough;
}

float height_at(LightMapJob job, ivec2 texel) {
    return dot(job.height, points[job.first_point + uint(texel.y) * job.columns + uint(texel.x)].position);
}

// The mean height of a curved surface's cell; curved_rough if a corner is missing or there is a step.
float cell_height(LightMapJob job, ivec2 cell) {
    float low = 1e30, high = -1e30, sum = 0.0;
    bool whole = true;
    for (int i = 0; i < 4; ++i) {
        const ivec2 corner = cell + ivec2(i & 1, i >> 1);
        const bool there = exists(job, corner);
        const float height = height_at(job, there ? corner : cell);
        whole = whole && there;
        low = min(low, height);
        high = max(high, height);
        sum += height;
    }
    return whole && high - low <= curved_cell_span * job.cell ? 0.25 * sum : curved_rough;
}

void main() {
    const uint number = gl_WorkGroupID.y * constants.row_length + gl_WorkGroupID.x;
    if (number >= constants.jobs)
        return;
    const LightMapJob job = job_at(number);
    const uint end = job.first + job.count;
    uint i = job.first + gl_LocalInvocationID.x;
    if (i < end) do { // tested at its end: see light.comp
        const ivec2 texel = ivec2(i % job.columns, i / job.columns);
        const bool inside = texel.x + 1 < int(job.columns) && texel.y + 1 < int(job.rows);
        const vec3 light = light_at(job, texel) / constants.fixed_point;
        const bool representable = all(lessThan(light, vec3(largest_half)));
        const bool rough = !representable || (inside && is_rough(job, texel));
        float shown = rough ? 1.0 : 0.0;
        if (job.first_point != no_points)
            shown = rough || !inside ? curved_rough : cell_height(job, texel);
        texels[job.first_texel + i] =
            uvec2(packHalf2x16(min(light.rg, vec2(largest_half))),
                  packHalf2x16(vec2(min(light.b, largest_half), shown)));
        i += 64u;
    } while (i < end);
}

#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// Converts baked light to the format that pixels read, and marks rough cells: those between four texels that cannot be
// interpolated.
#include "gi_module/charts/curved_charts_shared.h"
#include "gi_module/many_light/light_maps_shared.h"

layout(local_size_x = 8) in;
layout(set = 0, binding = 0) uniform usamplerBuffer jobs; // LightMapJobs
layout(set = 0, binding = 1) uniform isamplerBuffer sums;
layout(set = 0, binding = 2) buffer Texels { uvec2 texels[]; };
layout(set = 0, binding = 3) readonly buffer Points { CurvedPoint points[]; };
layout(set = 0, binding = 4) uniform usamplerBuffer refined_texels;
layout(push_constant) uniform Constants { LightMapConstants constants; };

#include "gi_module/many_light/light_map_job.glsl"
#include "gi_module/many_light/refined_texel.glsl"

const float largest_half = 65504.0;

int place_of(LightMapJob job, ivec2 texel) {
    return int(job.first_texel) + clamp(texel.y * int(job.columns) + texel.x, 0, int(job.columns * job.rows) - 1);
}

vec3 sum_at(int place) { return vec3(texelFetch(sums, place).xyz); }

// As it is shown. Of places beside the map, something that is not looked at.
vec3 light_at(LightMapJob job, ivec2 texel) {
    const int place = place_of(job, texel);
    if (constants.refined == 0u)
        return sum_at(place);
    const RefinedTexel refined = to_refined_texel(texelFetch(refined_texels, place).rg);
    return sum_at(refined.source) * refined.ratio;
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

// A block of texels that an invocation finishes: neighbours share what they read. About it lie one column and row of
// texels before, and two after, as a cell's corners have neighbours.
const int block_columns = 2, block_rows = 4;
const int region_columns = block_columns + 3, region_rows = block_rows + 3;
struct Region {
    vec3 light[region_columns * region_rows];
    bool there[region_columns * region_rows];
};

Region read_region(LightMapJob job, ivec2 block) {
    Region region;
    [[unroll]] for (int y = 0; y < region_rows; ++y)
        [[unroll]] for (int x = 0; x < region_columns; ++x) {
            const bool is_corner = (x == 0 || x == region_columns - 1) && (y == 0 || y == region_rows - 1);
            const ivec2 texel = block + ivec2(x, y) - 1;
            region.light[y * region_columns + x] = is_corner ? vec3(0.0) : light_at(job, texel);
            region.there[y * region_columns + x] = !is_corner && exists(job, texel);
        }
    return region;
}

// Whether light about a texel, at `here` of its region, cannot be interpolated along a row or column.
bool is_uneven(LightMapJob job, Region region, int here) {
    bool uneven = false;
    [[unroll]] for (int axis = 0; axis < 2; ++axis) {
        const int step = axis == 0 ? 1 : region_columns;
        const bool before = region.there[here - step], after = region.there[here + step];
        const vec3 one = region.light[here - step], own = region.light[here], other = region.light[here + step];
        // The rim of a curved surface, or the only cell of a patch along this axis.
        const bool rim = job.first_point != no_points || (axis == 0 ? job.columns : job.rows) == 2u;
        uneven = uneven || (before && after ? bends(one, own, other) : rim && differ(before ? one : other, own));
    }
    return uneven;
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

void finish(LightMapJob job, ivec2 texel, vec3 sum, bool uneven) {
    const bool inside = texel.x + 1 < int(job.columns) && texel.y + 1 < int(job.rows);
    const vec3 light = sum / constants.fixed_point;
    const bool representable = all(lessThan(light, vec3(largest_half)));
    const bool rough = !representable || (inside && uneven);
    float shown = rough ? 1.0 : 0.0;
    if (job.first_point != no_points)
        shown = rough || !inside ? curved_rough : cell_height(job, texel);
    texels[job.first_texel + uint(texel.y) * job.columns + uint(texel.x)] =
        uvec2(packHalf2x16(min(light.rg, vec2(largest_half))), packHalf2x16(vec2(min(light.b, largest_half), shown)));
}

// A cell is rough if the light about any of its four corners is uneven.
void finish_block(LightMapJob job, ivec2 block) {
    const Region region = read_region(job, block);
    bool uneven[block_rows + 1][block_columns + 1];
    [[unroll]] for (int y = 0; y <= block_rows; ++y)
        [[unroll]] for (int x = 0; x <= block_columns; ++x)
            uneven[y][x] = is_uneven(job, region, (y + 1) * region_columns + x + 1);
    [[unroll]] for (int y = 0; y < block_rows; ++y)
        [[unroll]] for (int x = 0; x < block_columns; ++x)
            if (all(lessThan(block + ivec2(x, y), ivec2(job.columns, job.rows))))
                finish(job, block + ivec2(x, y),
                       constants.refined != 0u ? sum_at(place_of(job, block + ivec2(x, y))) : region.light[(y + 1) * region_columns + x + 1],
                       uneven[y][x] || uneven[y][x + 1] || uneven[y + 1][x] || uneven[y + 1][x + 1]);
}

// Light that changes, where what is rough stays as it was for now.
void convert(LightMapJob job, uint i) {
    const vec3 light = vec3(texelFetch(sums, int(job.first_texel + i)).xyz) / constants.fixed_point;
    const bool representable = all(lessThan(light, vec3(largest_half)));
    const float shown = unpackHalf2x16(texels[job.first_texel + i].y).y;
    const float rough = job.first_point != no_points ? curved_rough : 1.0;
    texels[job.first_texel + i] = uvec2(packHalf2x16(min(light.rg, vec2(largest_half))),
                                        packHalf2x16(vec2(min(light.b, largest_half), representable ? shown : rough)));
}

// A job is a whole patch or chart.
void main() {
    const uint number = gl_WorkGroupID.y * constants.row_length + gl_WorkGroupID.x;
    if (number >= constants.jobs)
        return;
    const LightMapJob job = job_at(number);
    uint t = job.clear != 0u ? job.columns * job.rows : gl_LocalInvocationID.x;
    if (t < job.columns * job.rows) do {
        convert(job, t);
        t += gl_WorkGroupSize.x;
    } while (t < job.columns * job.rows);
    const uint across = (job.columns + uint(block_columns) - 1u) / uint(block_columns);
    const uint blocks = across * ((job.rows + uint(block_rows) - 1u) / uint(block_rows));
    uint i = job.clear != 0u ? gl_LocalInvocationID.x : blocks;
    if (i < blocks) do { // tested at its end: see light.comp
        finish_block(job, ivec2(i % across, i / across) * ivec2(block_columns, block_rows));
        i += gl_WorkGroupSize.x;
    } while (i < blocks);
}

#version 460
#extension GL_GOOGLE_include_directive : require
// Which pixel lights of a batch are evaluated at the nodes of which tiles, from the largest tiles down. What is neither
// done at a larger tile nor out of reach is left to the next level, and at the end to the pixels of the group.
#include "engine/scene/camera_shared.h"
#include "gi_module/splatting/splatting_shared.h"

layout(local_size_x = 8) in;
layout(set = 0, binding = 0) uniform Lights { PixelLightRow lights[splats_per_batch]; };
layout(set = 0, binding = 1) readonly buffer Tiles { SplatTile tiles[]; };
layout(set = 0, binding = 2) buffer Done { uint done[]; };               // of a tile: here, above, or without light
layout(set = 0, binding = 3) writeonly buffer Smooth { uint smooth_masks[]; }; // of a tile: at its nodes
layout(set = 0, binding = 4) writeonly buffer Masks { uint masks[]; };   // of a pixel group: at its pixels
layout(set = 0, binding = 5) readonly buffer Patches { GroupPatches groups[]; };
layout(push_constant) uniform Constants { SplattingConstants constants; };
#include "gi_module/splatting/splat_reach.glsl"

// Far from a piece of surface, and all of that in front. Nearer, irradiance has a bend or a peak there. Or one of both is
// behind the other, which then gets nothing; `faint`: a light on the same plane gives no more than that of what it could.
const float faint = 1e-3;
bool is_smooth(PixelLightRow light, vec4 plane, vec4 sphere) {
    const vec3 way = sphere.xyz - light.row.position_bound.xyz;
    const float squared = dot(way, way), far = constants.near * sphere.w;
    const float along = dot(light.row.normal_offset.xyz, way);
    if (sphere.w < 0.0 || along < -sphere.w)
        return sphere.w >= 0.0;
    if (dot(plane.xyz, light.row.position_bound.xyz) - plane.w <= faint * sqrt(squared))
        return true;
    return squared + light.extent.x * light.extent.x > far * far && along > sphere.w;
}

// Over all pieces of a group, and over the pixels of each of its points, which get all the same: for those, a light is
// far enough away where it is so many times farther than they are apart.
const float point_reaches = 10.0;
bool is_smooth_group(PixelLightRow light, uint group, GroupBounds bounds) {
    const vec3 position = light.row.position_bound.xyz, gap = max(max(bounds.low - position, position - bounds.high), vec3(0.0));
    const float far = max(constants.near, point_reaches) * groups[group].apart.x;
    bool is = groups[group].patches + groups[group].points > 0u && dot(gap, gap) + light.extent.x * light.extent.x >= far * far;
    for (uint i = 0; i < groups[group].patches; ++i) {
        // What bends has no one plane to be behind.
        const vec4 plane = groups[group].curved != 0u ? vec4(0.0, 0.0, 0.0, -1e30) : groups[group].plane[i];
        is = is && is_smooth(light, plane, groups[group].sphere[i]);
    }
    return is;
}

void main() {
    const uint index = gl_GlobalInvocationID.x, level = constants.level;
    if (index >= tiles_of_level(constants.columns, constants.rows, level))
        return;
    const uint across = tiles_along(constants.columns, level), above = tiles_along(constants.columns, level + 1u);
    const uint parent = first_tile(constants.columns, constants.rows, level + 1u) + index / across / 2u * above + index % across / 2u;
    const uint own = first_tile(constants.columns, constants.rows, level) + index;
    const SplatTile tile = tiles[own];
    const GroupBounds bounds = GroupBounds(tile.low.xyz, tile.high.xyz, tile.normal_low.xyz, tile.normal_high.xyz);
    for (uint word = 0; word < splat_mask_words; ++word) {
        uint finished = level + 1u < tile_levels ? done[parent * splat_mask_words + word] : 0u, at_nodes = 0u;
        const uint first = word * 32u, end = tile.low.w > 0.0 ? min(first + 32u, constants.light_count) : first;
        uint left = end > first ? (end - first >= 32u ? 0xffffffffu : (1u << (end - first)) - 1u) & ~finished : 0u;
        while (left != 0u) {
            const uint light = uint(findLSB(left)), bit = 1u << light;
            left &= left - 1u;
            const bool reaches = may_reach(lights[first + light], bounds);
            const bool here = reaches && (level == 0u ? is_smooth_group(lights[first + light], index, bounds)
                                                      : is_smooth(lights[first + light], tile.plane, tile.sphere));
            finished |= !reaches || here ? bit : 0u;
            at_nodes |= here ? bit : 0u;
        }
        done[own * splat_mask_words + word] = finished;
        smooth_masks[own * splat_mask_words + word] = at_nodes;
        if (level == 0u) {
            const uint all = end > first ? (end - first >= 32u ? 0xffffffffu : (1u << (end - first)) - 1u) : 0u;
            masks[index * splat_mask_words + word] = all & ~finished;
        }
    }
}

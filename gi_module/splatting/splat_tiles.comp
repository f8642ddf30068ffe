#version 460
#extension GL_GOOGLE_include_directive : require
// What the pixels of each tile show: boxes around them, and whether they are one flat piece of surface. Level 0 is in
// splat_patches.comp; here the others, from four tiles of the level before.
#include "engine/scene/camera_shared.h"
#include "gi_module/splatting/splatting_shared.h"

layout(local_size_x = 8) in;
layout(set = 0, binding = 0) uniform Camera { CameraRow camera; };
layout(set = 0, binding = 1) buffer Tiles { SplatTile tiles[]; };
layout(push_constant) uniform Constants { SplattingConstants constants; };
#include "gi_module/splatting/splat_tile.glsl"

void add_box(inout SplatTile tile, SplatTile part) {
    tile.low.xyz = min(tile.low.xyz, part.low.xyz);
    tile.high = max(tile.high, part.high);
    tile.normal_low = min(tile.normal_low, part.normal_low);
    tile.normal_high = max(tile.normal_high, part.normal_high);
    if (tile.low.w == 0.0 && part.low.w > 0.0) {
        tile.plane = part.plane;
        tile.geometric = part.geometric;
    }
    tile.low.w = max(tile.low.w, part.low.w);
}

SplatTile part_of(uint index, uint part) {
    const uvec2 place = tile_place(constants.level, index) * 2u + uvec2(part & 1u, part >> 1);
    if (any(greaterThanEqual(place, tile_grid(constants.level - 1u))))
        return no_tile;
    return tiles[tile_at(constants.level - 1u, place)];
}

bool continues(SplatTile tile, SplatTile part, float size) {
    const vec3 turn = part.plane.xyz - tile.plane.xyz, mesh = part.geometric.xyz - tile.geometric.xyz;
    const float off = dot(tile.plane.xyz, 0.5 * (part.low.xyz + part.high.xyz)) - tile.plane.w;
    return part.sphere.w >= 0.0 && dot(turn, turn) <= flat_normals && dot(mesh, mesh) <= flat_normals &&
           abs(off) <= flat_positions * size;
}

void main() {
    const uint index = gl_GlobalInvocationID.x;
    if (index >= tiles_of_level(constants.columns, constants.rows, constants.level))
        return;
    SplatTile tile = no_tile;
    for (uint i = 0; i < 4u; ++i)
        add_box(tile, part_of(index, i));
    bool is_flat = tile.low.w > 0.0;
    const float size = distance(tile.low.xyz, tile.high.xyz);
    for (uint i = 0; i < 4u; ++i) {
        const SplatTile part = part_of(index, i);
        is_flat = is_flat && (part.low.w == 0.0 || continues(tile, part, size));
    }
    if (is_flat)
        tile.sphere = sphere_of(tile.plane, tile_place(constants.level, index));
    tiles[first_tile(constants.columns, constants.rows, constants.level) + index] = tile;
}

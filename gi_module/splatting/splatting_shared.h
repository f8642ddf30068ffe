// Constants and structs that the kernels of splatted light share with the CPU.
#ifndef SUNFLECK_GI_SPLATTING_SPLATTING_SHARED_H
#define SUNFLECK_GI_SPLATTING_SPLATTING_SHARED_H
#include "gi_module/low_resolution/low_resolution_shared.h"
#include "gi_module/transport/pixel_light_shared.h"
SHARED_BEGIN

// Pixel lights of a dispatch: 40 KiB of rows, within the uniform buffer range of every supported device. Which of them
// reach a pixel group is a mask of a bit each.
SHARED_CONSTANT uint splats_per_batch = 256u;
SHARED_CONSTANT uint splat_mask_words = 8u;

// Lobes are narrow: of a group's lights, each block of 4x2 of its pixels has a mask of those that reach it, after a
// word that says which words of the mask are not empty.
SHARED_CONSTANT uint splat_blocks = 8u;       // of a group
SHARED_CONSTANT uint splat_block_pixels = 8u; // as many as a CPU's lanes
SHARED_CONSTANT uint splat_block_words = splat_mask_words + 1u;
// A pixel of a block, as an entry of its group.
SHARED_FUNCTION uint splat_block_entry(uint block, uint pixel) {
    return (block / 2u * 2u + pixel / 4u) * pixel_group_side + block % 2u * 4u + pixel % 4u;
}

// Debug views in place of light.
SHARED_CONSTANT uint show_no_splats = 0u;
SHARED_CONSTANT uint show_overdraw = 1u;        // lights that are evaluated for a pixel
SHARED_CONSTANT uint show_splat_occlusion = 2u; // share of their light that arrives
SHARED_CONSTANT uint show_splat_places = 3u;    // where the lights are
SHARED_CONSTANT uint show_map_flux = 4u;        // texels of the reflective shadow maps, by flux
SHARED_CONSTANT uint show_importance = 5u;      // the same by importance
SHARED_CONSTANT float most_overdraw = 256.0f;   // white

// Dots where lights or texels are.
SHARED_FUNCTION bool shows_places(uint show) {
    return show == show_splat_places || show == show_map_flux || show == show_importance;
}

struct SplattingConstants {
    uint width; // of the picture
    uint height;
    uint group_count; // pixel groups of the low-resolution picture
    uint light_count; // in this batch
    uint map_side;    // texels of a light's shadow map
    float least;      // irradiance, W/m2, below which light may be cut; 0: nowhere
    uint scale;       // full-resolution pixels per low-resolution pixel, in each direction
    uint columns;     // of pixel groups in the low-resolution picture
    uint rows;
    uint level; // of tiles that are handled
    uint first; // 1: the first batch that has nodes
    float near; // a light is smooth over a tile that is farther from it than so many of the tile's radii
};

// --- Multiresolution ------------------------------------------------------------------------------------------------
// The low-resolution picture is divided into tiles of 8 pixels a side (level 0: its pixel groups), of 16, 32 and 64. A
// light that is smooth over a flat tile is evaluated at eight nodes of the tile, its corners and the middles of its
// sides, and interpolated in between; each light at the largest tile for which that holds. A group with several flat
// pieces has corners for each, and points for the pixels that belong to none, which pixels that are alike share:
// GroupPatches.
SHARED_CONSTANT uint tile_levels = 4u;
SHARED_CONSTANT uint tile_nodes = 8u;
SHARED_CONSTANT uint corner_nodes = 4u; // the first of those
SHARED_CONSTANT uint group_patches = 4u;
SHARED_CONSTANT uint group_waves = 7u; // of eight nodes or points; what takes more is cheaper pixel by pixel

struct GroupPatches {
    uint patches;                  // with nodes each
    uint points;                   // pixels, after them
    uint curved;                   // 1: the only patch bends, and has its nodes at pixels
    uint nodes;                    // of each patch: tile_nodes, or corner_nodes where the group is in pieces
    vec4 apart;                    // x: of the pixels of a point, how far from the first, m
    vec4 plane[group_patches];     // xyz: normal, w: its product with points on the plane
    vec4 geometric[group_patches]; // xyz: normal of the mesh
    vec4 sphere[group_patches];    // about the group's part of the plane
};
// Of an entry of a group: the patch that its pixel belongs to, or group_patches + number of its point. And the pixel
// that the entry's point lies at: points are entries 0, 1, ... of a group.
SHARED_CONSTANT uint place_bits = 8u;

struct SplatTile { // positions and normals of its lit pixels
    vec4 low;      //  0: xyz: of the box about them; w: 1 if there are any
    vec4 high;     // 16
    vec4 normal_low;
    vec4 normal_high; // 48
    vec4 plane;       // 64: xyz: normal, w: its product with points on the plane
    vec4 geometric;   // 80: xyz: normal of the mesh
    vec4 sphere;      // 96: about the tile's part of the plane; w: radius, < 0 if the tile is not flat
};

SHARED_FUNCTION uint tiles_along(uint groups, uint level) {
    return (groups + (1u << level) - 1u) >> level;
}
SHARED_FUNCTION uint tiles_of_level(uint columns, uint rows, uint level) {
    return tiles_along(columns, level) * tiles_along(rows, level);
}
// Place of a level's first tile among all.
SHARED_FUNCTION uint first_tile(uint columns, uint rows, uint level) {
    uint first = 0u;
    for (uint i = 0u; i < level; ++i)
        first += tiles_of_level(columns, rows, i);
    return first;
}

// Weight of a node at a place in a tile, both coordinates -1 to 1: the serendipity quadrilateral of the finite-element
// method, exact for polynomials of degree 2. Nodes 0 to 3: corners, x first; 4, 5: left, right; 6, 7: top, bottom.
SHARED_FUNCTION vec2 node_place(uint node) {
    if (node < 4u)
        return vec2((node & 1u) != 0u ? 1.0f : -1.0f, (node & 2u) != 0u ? 1.0f : -1.0f);
    float side = (node & 1u) != 0u ? 1.0f : -1.0f;
    return node < 6u ? vec2(side, 0.0f) : vec2(0.0f, side);
}
SHARED_FUNCTION float node_weight(uint node, vec2 place) {
    vec2 own = node_place(node), along = place * own;
    if (node < 4u)
        return 0.25f * (1.0f + along.x) * (1.0f + along.y) * (along.x + along.y - 1.0f);
    return node < 6u ? 0.5f * (1.0f + along.x) * (1.0f - place.y * place.y)
                     : 0.5f * (1.0f + along.y) * (1.0f - place.x * place.x);
}
// The same with the corners alone, bilinearly.
SHARED_FUNCTION float corner_weight(uint node, vec2 place) {
    vec2 along = place * node_place(node);
    return 0.25f * (1.0f + along.x) * (1.0f + along.y);
}
// Of a group, how often eight invocations evaluate a light at its nodes and points.
SHARED_FUNCTION uint waves_of(uint patches, uint nodes, uint points) {
    return (patches * nodes + points + tile_nodes - 1u) / tile_nodes;
}

SHARED_END
#ifdef __cplusplus
static_assert(sizeof(sunfleck::shared::SplattingConstants) == 48);
static_assert(sizeof(sunfleck::shared::SplatTile) == 112);
static_assert(sizeof(sunfleck::shared::GroupPatches) == 32 + 48 * sunfleck::shared::group_patches);
static_assert(sunfleck::shared::splats_per_batch == 32 * sunfleck::shared::splat_mask_words);
static_assert(sunfleck::shared::splat_blocks * sunfleck::shared::splat_block_pixels ==
              sunfleck::shared::pixel_group_size);
#endif
#endif

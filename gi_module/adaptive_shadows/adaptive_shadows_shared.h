// What punctual_light.glsl shares with the CPU.
#ifndef SUNFLECK_GI_ADAPTIVE_SHADOWS_ADAPTIVE_SHADOWS_SHARED_H
#define SUNFLECK_GI_ADAPTIVE_SHADOWS_ADAPTIVE_SHADOWS_SHARED_H
#include "gi_module/transport/light_row_shared.h"
SHARED_BEGIN

// A light's map is divided into 2^level x 2^level tiles. A tile has `tile_inner` texels of its own along a side and
// repeats `tile_border` of each neighbour, so that a filtered look-up stays within one tile.
SHARED_CONSTANT uint tile_side = 256u;
SHARED_CONSTANT uint tile_border = 2u;
SHARED_CONSTANT uint tile_inner = tile_side - 2u * tile_border;
SHARED_CONSTANT uint tile_levels = 8u; // levels 0 to 7: up to 32,256 texels along a side

// What a light's map shows; the lights that a dispatch adds are of one kind.
SHARED_CONSTANT uint map_of_sphere = 0u;     // point lights, wide spots
SHARED_CONSTANT uint map_of_cone = 1u;       // narrow spots
SHARED_CONSTANT uint map_of_directions = 2u; // suns

// An entry of a light's table: which tile serves a cell of the finest level in use. 0: none has been drawn yet.
SHARED_CONSTANT uint tile_level_shift = 24u; // level; in the bits below it, slot + 1

struct TileLight {
    LightRow row;
    uint table_first; // entry
    uint table_side;  // entries along a side, a power of two
    uint unused0, unused1;
};

SHARED_CONSTANT uint map_kinds = 3u;

SHARED_CONSTANT uint lights_per_pass = 32u; // a bit for each in a word

// The picture is lit in blocks of 8 rows. A word for each says which lights of the batch may light any of its pixels;
// for each kind of map, those that have any are listed.
SHARED_CONSTANT uint block_rows = 8u;
struct LitBlock {
    uint block; // row after row
    uint lights;
};
// Every device dispatches so many groups side by side. Pictures with more blocks take several rows of groups, and a
// list is filled up with blocks below the picture until its rows are equally long.
SHARED_CONSTANT uint most_groups = 65535u;
SHARED_FUNCTION uint rows_of_groups(uint blocks) {
    return (blocks + most_groups - 1u) / most_groups;
}
SHARED_FUNCTION uint list_stride(uint blocks) {
    return blocks + rows_of_groups(blocks);
}

struct PunctualConstants {
    uint width;
    uint height;
    uint light_count;
    uint block_columns; // blocks side by side
    uint block_count;
    uint kind_lights[map_kinds]; // of the batch, by kind of map
};

SHARED_END
#ifdef __cplusplus
static_assert(sizeof(sunfleck::shared::TileLight) == 96);
#endif
#endif

// What the kernels that light pixels at low resolution agree on, whichever technique they belong to.
//
// Pixels are lit in groups of 64: tiles of 8x8 pixels of the low-resolution picture, or 64 pixels of one region that
// are lit at full resolution to repair it. Each pixel of a group is an entry; techniques add its light to the entry's
// sum.
#ifndef SUNFLECK_GI_LOW_RESOLUTION_LOW_RESOLUTION_SHARED_H
#define SUNFLECK_GI_LOW_RESOLUTION_LOW_RESOLUTION_SHARED_H
#include "engine/core/shader_language.h"
SHARED_BEGIN

SHARED_CONSTANT uint pixel_group_size = 64u;
SHARED_CONSTANT uint pixel_group_side = 8u; // of a tile, in pixels of the low-resolution picture
// An entry's pixel: x in the low 16 bits, y from bit 16. The top bit: nothing to light there (background, or no pixel).
SHARED_CONSTANT uint no_pixel = 0xffffffffu;
SHARED_CONSTANT uint unlit_pixel = 0x80000000u;

struct LowResolutionConstants {
    uint width; // of the picture
    uint height;
    uint low_width;
    uint low_height;
    uint scale;          // full pixels a low-resolution pixel, in each direction
    uint group_columns;  // of the low-resolution picture
    uint group_count;    // of the low-resolution picture
    uint group_capacity; // groups of repaired pixels that the buffers hold
    uint cell_columns;   // cells between low-resolution pixels
    uint cell_rows;
    uint block_columns; // blocks of 8x8 cells
    uint block_count;
    float contrast;     // neighbours that differ by more, relative to the brighter, are not blended
    float normal_limit; // squared distance of octahedral normals within which neighbours are blended
};

// Places of the indirect commands that a compaction writes, in uints.
SHARED_CONSTANT uint command_groups = 0u; // a work group for each group
SHARED_CONSTANT uint command_packed = 4u; // a work group for eight groups
SHARED_CONSTANT uint command_totals = 8u; // entries wanted, entries that fit, groups
SHARED_CONSTANT uint command_words = 12u;

SHARED_END
#ifdef __cplusplus
static_assert(sizeof(sunfleck::shared::LowResolutionConstants) == 56);
#endif
#endif

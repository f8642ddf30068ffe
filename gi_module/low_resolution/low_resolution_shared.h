// Constants and structs that all kernels share which light pixels at low resolution, whichever technique they belong
// to.
//
// Pixels are lit in pixel groups of 64: tiles of 8x8 pixels of the low-resolution picture, or 64 pixels of one region
// that are lit at full resolution to repair it. Each pixel of a group is an entry (entry / 64 is the group); techniques
// add light to the entry's sum.
#ifndef SUNFLECK_GI_LOW_RESOLUTION_LOW_RESOLUTION_SHARED_H
#define SUNFLECK_GI_LOW_RESOLUTION_LOW_RESOLUTION_SHARED_H
#include "engine/core/shader_language.h"
SHARED_BEGIN

SHARED_CONSTANT uint pixel_group_size = 64u;
SHARED_CONSTANT uint pixel_group_side = 8u; // side of a tile, in pixels of the low-resolution picture
// The pixel of an entry: x in the low 16 bits, y from bit 16. The top bit is set if there is nothing to light
// (background or no pixel).
SHARED_CONSTANT uint no_pixel = 0xffffffffu;
SHARED_CONSTANT uint unlit_pixel = 0x80000000u;

struct LowResolutionConstants {
    uint width; // of the picture
    uint height;
    uint low_width;
    uint low_height;
    uint scale;          // full-resolution pixels per low-resolution pixel, in each direction
    uint group_columns;  // of pixel groups in the low-resolution picture
    uint group_count;    // pixel groups of the low-resolution picture
    uint group_capacity; // groups of repaired pixels that the buffers have room for
    uint cell_columns;   // cells between low-resolution pixels
    uint cell_rows;
    uint block_columns; // blocks of 8x8 cells
    uint block_count;
    float contrast;     // neighbours that differ by more, relative to the brighter one, are not blended
    float normal_limit; // squared distance of octahedral normals within which neighbours are blended
};

// Offsets of the indirect commands that a compaction writes, in uints.
SHARED_CONSTANT uint command_groups = 0u; // a work group per pixel group
SHARED_CONSTANT uint command_packed = 4u; // a work group per eight pixel groups
SHARED_CONSTANT uint command_totals = 8u; // entries marked, entries that fit, pixel groups
SHARED_CONSTANT uint command_words = 12u;

SHARED_END
#ifdef __cplusplus
static_assert(sizeof(sunfleck::shared::LowResolutionConstants) == 56);
#endif
#endif

#version 460
#extension GL_GOOGLE_include_directive : require
// Compacts the pixels that the reconstruction marked for repair, in masks of cells, into pixel groups; in blocks of 8x8
// cells.
#include "gi_module/low_resolution/low_resolution_shared.h"

layout(local_size_x = 8) in;
layout(constant_id = 0) const uint action = 0; // compaction_...
layout(constant_id = 1) const int scale = 4;

layout(set = 0, binding = 0) readonly buffer CellMasks { uvec2 cell_masks[]; };
layout(set = 0, binding = 1) buffer BlockEntries { uint block_entries[]; };
layout(set = 0, binding = 2) buffer Commands { uint commands[]; };
layout(set = 0, binding = 3) writeonly buffer Pixels { uint listed[]; };
layout(push_constant) uniform Constants { LowResolutionConstants constants; };

const uint units_per_block = 64u;

uint block_count() { return constants.block_count; }
uint group_capacity() { return constants.group_capacity; }

uvec2 marked_in(uint block, uint i, out uint unit) {
    const uint column = block % constants.block_columns * 8u + i % 8u;
    const uint row = block / constants.block_columns * 8u + i / 8u;
    unit = row * constants.cell_columns + column;
    return column < constants.cell_columns && row < constants.cell_rows ? cell_masks[unit] : uvec2(0u);
}

uint listed_value(uint unit, int bit) {
    const ivec2 first = ivec2(unit % constants.cell_columns, unit / constants.cell_columns) * scale - scale / 2;
    const ivec2 pixel = first + ivec2(bit % scale, bit / scale);
    return uint(pixel.x) | (uint(pixel.y) << 16);
}

#include "gi_module/low_resolution/compaction.glsl"

void main() { compact(); }

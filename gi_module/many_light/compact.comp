#version 460
#extension GL_GOOGLE_include_directive : require
// The marked pixels as groups of 64: block after block of 8x8 cells, so that a group's pixels are neighbours. Three
// steps: count by block, prefix sum, fill. No atomics, so the order never varies.
#include "gi_module/many_light/many_light_shared.h"

layout(local_size_x = 8) in;
layout(constant_id = 0) const uint action = 0; // 0: count, 1: prefix sum (one work group), 2: fill
layout(constant_id = 1) const int scale = 4;

layout(set = 0, binding = 0) readonly buffer CellMasks { uvec2 cell_masks[]; };
layout(set = 0, binding = 1) buffer BlockPixels { uint block_pixels[]; }; // pixels of a block, then those of all before it
layout(set = 0, binding = 2) buffer Commands { uint commands[]; };
layout(set = 0, binding = 3) writeonly buffer Pixels { uint pixels[]; };
layout(push_constant) uniform Constants { ManyLightConstants constants; };

shared uint chunk_pixels[8];

uint cell_of(uint block, uint i, out bool inside) {
    const uint column = block % constants.block_columns * 8u + i % 8u;
    const uint row = block / constants.block_columns * 8u + i / 8u;
    inside = column < constants.cell_columns && row < constants.cell_rows;
    return row * constants.cell_columns + column;
}

void count_block(uint block) {
    uint total = 0u;
    for (uint i = 0; i < 64u; ++i) {
        bool inside;
        const uint cell = cell_of(block, i, inside);
        if (inside) {
            const uvec2 mask = cell_masks[cell];
            total += uint(bitCount(mask.x) + bitCount(mask.y));
        }
    }
    block_pixels[block] = total;
}

void sum_blocks() {
    const uint lane = gl_LocalInvocationID.x;
    const uint length = (constants.block_count + 7u) / 8u;
    const uint begin = min(lane * length, constants.block_count), end = min(begin + length, constants.block_count);
    uint wanted = 0u;
    for (uint block = begin; block < end; ++block)
        wanted += block_pixels[block];
    chunk_pixels[lane] = wanted;
    barrier();
    uint first = 0u, total_pixels = 0u;
    for (uint i = 0; i < 8u; ++i) {
        first += i < lane ? chunk_pixels[i] : 0u;
        total_pixels += chunk_pixels[i];
    }
    for (uint block = begin; block < end; ++block) {
        const uint own = block_pixels[block];
        block_pixels[block] = first;
        first += own;
    }
    if (lane != 0u)
        return;
    const uint total = min((total_pixels + group_pixels - 1u) / group_pixels, constants.group_capacity);
    for (uint i = total_pixels; i < total * group_pixels; ++i)
        pixels[i] = no_pixel;
    commands[command_groups] = total;
    commands[command_groups + 1u] = 1u;
    commands[command_groups + 2u] = 1u;
    commands[command_packed] = (total + 7u) / 8u;
    commands[command_packed + 1u] = 1u;
    commands[command_packed + 2u] = 1u;
    commands[command_totals] = total_pixels;
    commands[command_totals + 1u] = min(total_pixels, total * group_pixels);
    commands[command_totals + 2u] = total;
}

void fill_block(uint block) {
    uint place = block_pixels[block];
    const uint end = constants.group_capacity * group_pixels;
    for (uint i = 0; i < 64u; ++i) {
        bool inside;
        const uint cell = cell_of(block, i, inside);
        uvec2 mask = uvec2(0u);
        if (inside)
            mask = cell_masks[cell];
        const ivec2 first = ivec2(cell % constants.cell_columns, cell / constants.cell_columns) * scale - scale / 2;
        while ((mask.x | mask.y) != 0u && place < end) {
            const int bit = mask.x != 0u ? findLSB(mask.x) : 32 + findLSB(mask.y);
            if (bit < 32)
                mask.x &= mask.x - 1u;
            else
                mask.y &= mask.y - 1u;
            const ivec2 pixel = first + ivec2(bit % scale, bit / scale);
            pixels[place++] = uint(pixel.x) | (uint(pixel.y) << 16);
        }
    }
}

void main() {
    if (action == 1u)
        sum_blocks();
    else if (gl_GlobalInvocationID.x < constants.block_count) {
        if (action == 0u)
            count_block(gl_GlobalInvocationID.x);
        else
            fill_block(gl_GlobalInvocationID.x);
    }
}

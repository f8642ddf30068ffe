#version 460
#extension GL_GOOGLE_include_directive : require
// Marked pixels as groups of 64, neighbours together: those that a cell's mask names, block after block of 8x8 cells; or
// the entries of a stage's groups that did not take baked light. Three steps: count by block, prefix sum, fill. No
// atomics, so the order never varies.
#include "gi_module/many_light/many_light_shared.h"
#include "gi_module/visibility/surface_lookup_shared.h"

layout(local_size_x = 8) in;
layout(constant_id = 0) const uint action = 0; // 0: count, 1: prefix sum (one work group), 2: fill
layout(constant_id = 1) const int scale = 4;
layout(constant_id = 2) const uint from_entries = 0; // 1: units are groups, not cells
layout(constant_id = 3) const uint indirect = 0;     // 1: the number of those groups is in their commands

layout(set = 0, binding = 0) readonly buffer CellMasks { uvec2 cell_masks[]; };
layout(set = 0, binding = 1) buffer BlockPixels { uint block_pixels[]; }; // pixels of a block, then those of all before it
layout(set = 0, binding = 2) buffer Commands { uint commands[]; };
layout(set = 0, binding = 3) writeonly buffer Pixels { uint pixels[]; };
layout(set = 0, binding = 4) readonly buffer EntryPixels { uint entry_pixels[]; };
layout(set = 0, binding = 5) readonly buffer NodeOfEntry { uint entry_nodes[]; };
layout(set = 0, binding = 6) readonly buffer EntryCommands { uint entry_commands[]; };
layout(push_constant) uniform Constants { ManyLightConstants constants; };

const uint units_per_block = from_entries != 0 ? groups_per_block : 64u;

shared uint chunk_pixels[8];

uint block_count() { return from_entries != 0 ? constants.entry_blocks : constants.block_count; }

uint group_capacity() {
    return from_entries != 0 ? max(constants.group_capacity, constants.group_count) : constants.group_capacity;
}

uint cell_of(uint block, uint i, out bool inside) {
    const uint column = block % constants.block_columns * 8u + i % 8u;
    const uint row = block / constants.block_columns * 8u + i / 8u;
    inside = column < constants.cell_columns && row < constants.cell_rows;
    return row * constants.cell_columns + column;
}

uvec2 rough_entries_of(uint group) {
    uvec2 mask = uvec2(0u);
    const uint group_count = indirect != 0 ? entry_commands[command_totals + 2u] : constants.group_count;
    for (uint i = 0; i < group_pixels && group < group_count; ++i) {
        const uint entry = group * group_pixels + i;
        const uint node = entry_nodes[entry];
        const bool rough = (entry_pixels[entry] & unlit_pixel) == 0u && (node == no_node || (node & node_baked) == 0u);
        const uint bit = rough ? 1u << (i & 31u) : 0u;
        mask |= i < 32u ? uvec2(bit, 0u) : uvec2(0u, bit);
    }
    return mask;
}

// What is marked in one of a block's units, and which unit of all it is.
uvec2 marked_in(uint block, uint i, out uint unit) {
    if (from_entries != 0) {
        unit = block * groups_per_block + i;
        return rough_entries_of(unit);
    }
    bool inside;
    unit = cell_of(block, i, inside);
    return inside ? cell_masks[unit] : uvec2(0u);
}

void count_block(uint block) {
    uint total = 0u;
    for (uint i = 0; i < units_per_block; ++i) {
        uint unit;
        const uvec2 mask = marked_in(block, i, unit);
        total += uint(bitCount(mask.x) + bitCount(mask.y));
    }
    block_pixels[block] = total;
}

void sum_blocks() {
    const uint lane = gl_LocalInvocationID.x;
    const uint length = (block_count() + 7u) / 8u;
    const uint begin = min(lane * length, block_count()), end = min(begin + length, block_count());
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
    const uint total = min((total_pixels + group_pixels - 1u) / group_pixels, group_capacity());
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
    const uint end = group_capacity() * group_pixels;
    for (uint i = 0; i < units_per_block; ++i) {
        uint unit;
        uvec2 mask = marked_in(block, i, unit);
        const ivec2 first = ivec2(unit % constants.cell_columns, unit / constants.cell_columns) * scale - scale / 2;
        while ((mask.x | mask.y) != 0u && place < end) {
            const int bit = mask.x != 0u ? findLSB(mask.x) : 32 + findLSB(mask.y);
            if (bit < 32)
                mask.x &= mask.x - 1u;
            else
                mask.y &= mask.y - 1u;
            const ivec2 pixel = first + ivec2(bit % scale, bit / scale);
            pixels[place++] = from_entries != 0 ? unit * group_pixels + uint(bit) : uint(pixel.x) | (uint(pixel.y) << 16);
        }
    }
}

void main() {
    if (action == 1u)
        sum_blocks();
    else if (gl_GlobalInvocationID.x < block_count()) {
        if (action == 0u)
            count_block(gl_GlobalInvocationID.x);
        else
            fill_block(gl_GlobalInvocationID.x);
    }
}

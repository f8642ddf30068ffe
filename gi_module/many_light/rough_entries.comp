#version 460
#extension GL_GOOGLE_include_directive : require
// Compacts the rough entries of a stage's pixel groups, those that do not use baked light, into pixel groups of their
// own.
#include "gi_module/many_light/many_light_shared.h"
#include "gi_module/visibility/surface_lookup_shared.h"

layout(local_size_x = 8) in;
layout(constant_id = 0) const uint action = 0;   // compaction_...
layout(constant_id = 1) const uint indirect = 0; // 1: the number of the stage's pixel groups is in its commands

layout(set = 0, binding = 0) buffer BlockEntries { uint block_entries[]; };
layout(set = 0, binding = 1) buffer Commands { uint commands[]; };
layout(set = 0, binding = 2) writeonly buffer Entries { uint listed[]; };
layout(set = 0, binding = 3) readonly buffer EntryPixels { uint entry_pixels[]; };
layout(set = 0, binding = 4) readonly buffer NodeOfEntry { uint entry_nodes[]; };
layout(set = 0, binding = 5) readonly buffer StageCommands { uint stage_commands[]; };
layout(push_constant) uniform Constants { ManyLightConstants constants; };

const uint units_per_block = pixel_groups_per_block;

uint block_count() { return constants.entry_blocks; }
uint group_capacity() { return max(constants.group_capacity, constants.group_count); }

uvec2 marked_in(uint block, uint i, out uint unit) {
    unit = block * pixel_groups_per_block + i;
    uvec2 mask = uvec2(0u);
    const uint group_count = indirect != 0 ? stage_commands[command_totals + 2u] : constants.group_count;
    for (uint k = 0; k < pixel_group_size && unit < group_count; ++k) {
        const uint entry = unit * pixel_group_size + k;
        const uint node = entry_nodes[entry];
        const bool rough = (entry_pixels[entry] & unlit_pixel) == 0u && (node == no_node || (node & node_baked) == 0u);
        const uint bit = rough ? 1u << (k & 31u) : 0u;
        mask |= k < 32u ? uvec2(bit, 0u) : uvec2(0u, bit);
    }
    return mask;
}

uint listed_value(uint unit, int bit) { return unit * pixel_group_size + uint(bit); }

#include "gi_module/low_resolution/compaction.glsl"

void main() { compact(); }

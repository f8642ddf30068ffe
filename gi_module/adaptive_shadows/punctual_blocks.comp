#version 460
#extension GL_GOOGLE_include_directive : require
// Lists the blocks that lights of a kind may reach, in their order, and writes the size of the dispatch that lights them:
// a group for each kind of map.
#include "gi_module/adaptive_shadows/adaptive_shadows_shared.h"

layout(local_size_x = 64) in;

layout(set = 0, binding = 0) readonly buffer Masks { uint block_lights[]; };
layout(set = 0, binding = 1) writeonly buffer Blocks { LitBlock lit_blocks[]; };
layout(set = 0, binding = 2) writeonly buffer Commands { uint commands[]; };
layout(push_constant) uniform Constants { PunctualConstants constants; };

shared uint counts[64];

void main() {
    const uint kind = gl_WorkGroupID.x, wanted = constants.kind_lights[kind];
    const uint self = gl_LocalInvocationID.x, share = (constants.block_count + 63u) / 64u;
    const uint begin = min(self * share, constants.block_count), end = min(begin + share, constants.block_count);
    uint count = 0u;
    for (uint block = begin; block < end; ++block)
        count += (block_lights[block] & wanted) != 0u ? 1u : 0u;
    counts[self] = count;
    barrier();
    const uint first = kind * list_stride(constants.block_count);
    uint next = first;
    for (uint i = 0u; i < self; ++i)
        next += counts[i];
    for (uint block = begin; block < end; ++block) {
        const uint lights = block_lights[block] & wanted;
        if (lights != 0u)
            lit_blocks[next++] = LitBlock(block, lights);
    }
    if (self == 63u) {
        const uint listed = next - first, rows = max(rows_of_groups(listed), 1u), columns = (listed + rows - 1u) / rows;
        while (next - first < columns * rows)
            lit_blocks[next++] = LitBlock(constants.block_count, wanted);
        commands[3u * kind] = columns;
        commands[3u * kind + 1u] = rows;
        commands[3u * kind + 2u] = 1u;
    }
}

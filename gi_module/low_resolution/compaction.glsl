// Stream compaction of marked entries into pixel groups of 64, neighbours together, in three steps: count per block,
// prefix sum, list. There are no atomics, so the order is deterministic.
//
// The including shader first declares: local_size_x 8; the constants `action` (compaction_...) and `units_per_block`;
// the buffers block_entries[] (marked entries in a block; after the prefix sum, in all blocks before it), commands[]
// (the indirect commands to write) and listed[]; and the functions block_count(); group_capacity(); marked_in(block, i,
// unit), the mask of marked entries in unit i of a block, and the index of that unit; listed_value(unit, bit), what to
// list.
const uint compaction_count = 0u, compaction_offsets = 1u, compaction_list = 2u;

shared uint chunk_entries[8];

void count_block(uint block) {
    uint total = 0u;
    for (uint i = 0; i < units_per_block; ++i) {
        uint unit;
        const uvec2 mask = marked_in(block, i, unit);
        total += uint(bitCount(mask.x) + bitCount(mask.y));
    }
    block_entries[block] = total;
}

void sum_blocks() {
    const uint lane = gl_LocalInvocationID.x;
    const uint length = (block_count() + 7u) / 8u;
    const uint begin = min(lane * length, block_count()), end = min(begin + length, block_count());
    uint marked = 0u;
    for (uint block = begin; block < end; ++block)
        marked += block_entries[block];
    chunk_entries[lane] = marked;
    barrier();
    uint first = 0u, total_entries = 0u;
    for (uint i = 0; i < 8u; ++i) {
        first += i < lane ? chunk_entries[i] : 0u;
        total_entries += chunk_entries[i];
    }
    for (uint block = begin; block < end; ++block) {
        const uint own = block_entries[block];
        block_entries[block] = first;
        first += own;
    }
    if (lane != 0u)
        return;
    const uint total = min((total_entries + pixel_group_size - 1u) / pixel_group_size, group_capacity());
    for (uint i = total_entries; i < total * pixel_group_size; ++i)
        listed[i] = no_pixel;
    commands[command_groups] = total;
    commands[command_groups + 1u] = 1u;
    commands[command_groups + 2u] = 1u;
    commands[command_packed] = (total + 7u) / 8u;
    commands[command_packed + 1u] = 1u;
    commands[command_packed + 2u] = 1u;
    commands[command_totals] = total_entries;
    commands[command_totals + 1u] = min(total_entries, total * pixel_group_size);
    commands[command_totals + 2u] = total;
}

void list_block(uint block) {
    uint place = block_entries[block];
    const uint end = group_capacity() * pixel_group_size;
    for (uint i = 0; i < units_per_block; ++i) {
        uint unit;
        uvec2 mask = marked_in(block, i, unit);
        if ((mask.x | mask.y) != 0u && place < end) do {
            const int bit = mask.x != 0u ? findLSB(mask.x) : 32 + findLSB(mask.y);
            if (bit < 32)
                mask.x &= mask.x - 1u;
            else
                mask.y &= mask.y - 1u;
            listed[place++] = listed_value(unit, bit);
        } while ((mask.x | mask.y) != 0u && place < end);
    }
}

void compact() {
    if (action == compaction_offsets)
        sum_blocks();
    else if (gl_GlobalInvocationID.x < block_count()) {
        if (action == compaction_count)
            count_block(gl_GlobalInvocationID.x);
        else
            list_block(gl_GlobalInvocationID.x);
    }
}

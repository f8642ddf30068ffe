// Constants that brute_force.comp shares with the CPU.
#ifndef SUNFLECK_GI_BRUTE_FORCE_BRUTE_FORCE_SHARED_H
#define SUNFLECK_GI_BRUTE_FORCE_BRUTE_FORCE_SHARED_H
#include "gi_module/transport/light_row_shared.h"
SHARED_BEGIN

// Values of the kernel's specialisation constants, by id:
// 0 pixels per invocation, 1 light class, 2 how maps are read, 3 filter (0, 1), 4 count clamped flux (0, 1),
// 5 lights from a storage buffer instead of a uniform buffer (0, 1), 6 bits of a map texel
SHARED_CONSTANT uint kernel_rows = 8u; // work group: 8 invocations wide, 8 high
SHARED_CONSTANT uint kernel_lanes = 8u;

struct BruteForceConstants {
    uint width;
    uint height;
    uint light_count;
    uint map_resolution;
    uint first_batch;   // 1: sums start at zero, otherwise they continue from the accumulation buffer
    uint last_batch;    // 1: the result is written to the output image, otherwise to the accumulation buffer
    uint group_columns; // of work groups
    uint first_row;     // of the picture in this dispatch; a multiple of kernel_rows
};

SHARED_END
#ifdef __cplusplus
static_assert(sizeof(sunfleck::shared::BruteForceConstants) == 32);
#endif
#endif

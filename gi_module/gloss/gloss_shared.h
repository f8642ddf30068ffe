// What gloss.comp shares with the CPU.
#ifndef SUNFLECK_GI_GLOSS_GLOSS_SHARED_H
#define SUNFLECK_GI_GLOSS_GLOSS_SHARED_H
#include "gi_module/transport/facets_shared.h"
#include "gi_module/transport/light_row_shared.h"
SHARED_BEGIN

// Rows of light samples have, in members that other kernels do not read for their class:
//   surface      tangent_scale.w: radius of the disc that it stands for, m; normal_offset.w: least alpha squared
//   directional  position_bound.w: tangent of the angle that it stands for

struct GlossConstants {
    uint x; // of the area, in pixels
    uint y;
    uint width;
    uint height;
    uint light_count;
    uint map_resolution;
    uint first_batch; // 1: sums start at zero, otherwise they continue from the buffer of sums
    uint last_batch;  // 1: the result is written to the image, otherwise to the buffer of sums
};

SHARED_END
#ifdef __cplusplus
static_assert(sizeof(sunfleck::shared::GlossConstants) == 32);
#endif
#endif

// Constants that light_sum.glsl shares with the CPU.
#ifndef SUNFLECK_GI_LIGHT_SUM_LIGHT_SUM_SHARED_H
#define SUNFLECK_GI_LIGHT_SUM_LIGHT_SUM_SHARED_H
#include "engine/core/shader_language.h"
SHARED_BEGIN

SHARED_CONSTANT uint light_sum_side = 8u; // of a work group, in pixels

// What is done with a pixel of the picture.
SHARED_CONSTANT uint light_sum_clear = 0u;   // no light; alpha 1 where there is a surface
SHARED_CONSTANT uint light_sum_add = 1u;     // the layer's light is added, on receivers of the given kinds
SHARED_CONSTANT uint light_sum_replace = 2u; // where the layer's alpha is not 0, its light replaces the picture's

// Kinds of receivers, as bits.
SHARED_CONSTANT uint receiver_fixed = 1u;
SHARED_CONSTANT uint receiver_mover = 2u;

struct LightSumConstants {
    uint x; // of the rectangle, in pixels
    uint y;
    uint width;
    uint height;
    uint mode;
    uint receivers; // kinds
};

SHARED_END
#ifdef __cplusplus
static_assert(sizeof(sunfleck::shared::LightSumConstants) == 24);
#endif
#endif

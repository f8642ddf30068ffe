// Constants of the passes that convert a host's G-buffer.
#ifndef SUNFLECK_GI_G_BUFFER_CONVERSION_SHARED_H
#define SUNFLECK_GI_G_BUFFER_CONVERSION_SHARED_H
#include "engine/core/shader_language.h"
SHARED_BEGIN

SHARED_CONSTANT uint conversion_side = 8u; // side of a work group, in pixels

struct DepthConversionConstants { // scene::DepthMapping
    vec2 slope;
    float background;
    float offset;
    float scale;
    uint width, height;
};

// Encodings of normals.
SHARED_CONSTANT uint normal_missing = 0u;  // geometric normals only: derived from depth
SHARED_CONSTANT uint normal_unsigned = 1u; // 0.5 * normal + 0.5
SHARED_CONSTANT uint normal_signed = 2u;

struct NormalConversionConstants {
    float depth_step; // resolution of near / distance in the depth format
    uint width, height;
};

SHARED_END
#endif

// sRGB transfer, for shaders and C++ alike.
#ifndef SUNFLECK_ENGINE_CORE_SRGB_H
#define SUNFLECK_ENGINE_CORE_SRGB_H
#include "engine/core/shader_language.h"
SHARED_BEGIN

// IEC 61966-2-1: decodes a value from 0 to 1.
SHARED_FUNCTION float linear_from_srgb(float s) {
    return s <= 0.04045f ? s / 12.92f : pow((s + 0.055f) / 1.055f, 2.4f);
}

SHARED_END
#endif

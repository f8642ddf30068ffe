// What constant_light.comp and the CPU agree on.
#ifndef SUNFLECK_TESTS_TECHNIQUES_CONSTANT_LIGHT_SHARED_H
#define SUNFLECK_TESTS_TECHNIQUES_CONSTANT_LIGHT_SHARED_H
#include "engine/core/shader_language.h"
SHARED_BEGIN

SHARED_CONSTANT uint constant_light_shows_nothing = 0u;
SHARED_CONSTANT uint constant_light_shows_surfaces = 1u;

struct ConstantLightConstants {
    uint width; // of the picture, pixels
    uint height;
    uint show;
    float irradiance; // W/m2
    uint work;        // ConstantLightSettings::constant_work
    float never;      // what that never makes
};

SHARED_END
#endif

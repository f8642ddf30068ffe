#ifndef SUNFLECK_GI_MANY_LIGHT_NEARBY_LIGHT_SHARED_H
#define SUNFLECK_GI_MANY_LIGHT_NEARBY_LIGHT_SHARED_H
#include "engine/core/shader_language.h"
SHARED_BEGIN

// A texel of baked light that sees other surfaces nearby, and which of the entries are its own.
struct NearbyRow {
    uint texel;
    uint first_entry;
    uint entries;
    uint constant; // pack_shared_exponent: irradiance that no texel holds, in constant_steps
};

// What it takes of the irradiance of another texel.
struct NearbyEntry {
    uint texel;
    uint weight; // pack_shared_exponent
};

SHARED_CONSTANT float constant_steps = 65536.0f; // of the sums' fixed point

struct NearbyLightConstants {
    uint rows;
    uint row_length; // of rows, since a dispatch is limited in each direction
    float own_steps; // as in RefinedLightConstants
};

SHARED_END
#ifdef __cplusplus
static_assert(sizeof(sunfleck::shared::NearbyRow) == 16);
static_assert(sizeof(sunfleck::shared::NearbyEntry) == 8);
#endif
#endif

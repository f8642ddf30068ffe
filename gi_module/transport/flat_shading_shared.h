// When a surface counts as flat-shaded: light that is stored for a flat patch assumes the normal of the patch.
#ifndef SUNFLECK_GI_TRANSPORT_FLAT_SHADING_SHARED_H
#define SUNFLECK_GI_TRANSPORT_FLAT_SHADING_SHARED_H
#include "engine/core/shader_language.h"
SHARED_BEGIN

// Squared distance between geometric and shading normal (unit vectors) below which they count as equal: 0.06 degrees, a
// few steps of 16 bits.
SHARED_CONSTANT float flat_shaded_limit = 1e-6f;

SHARED_END
#endif

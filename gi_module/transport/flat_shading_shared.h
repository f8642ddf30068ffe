// When a surface counts as flat-shaded: what is kept for a flat patch knows the patch's normal alone.
#ifndef SUNFLECK_GI_TRANSPORT_FLAT_SHADING_SHARED_H
#define SUNFLECK_GI_TRANSPORT_FLAT_SHADING_SHARED_H
#include "engine/core/shader_language.h"
SHARED_BEGIN

// Squared distance of the unit normals of a surface and its shading, up to which they count as one: 0.06 degrees, some
// steps of 16 bits.
SHARED_CONSTANT float flat_shaded_limit = 1e-6f;

SHARED_END
#endif

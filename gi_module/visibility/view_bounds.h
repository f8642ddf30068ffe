// What of the scene a view may show.
#pragma once

#include "engine/core/maths.h"

namespace sunfleck::gi {

// Whether any of a box may lie in the view. `view_projection`: world to clip, reverse depth without a far plane.
bool may_be_seen(const mat4& view_projection, const Bounds& bounds);

} // namespace sunfleck::gi

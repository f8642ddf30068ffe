// The sphere that parallel light comes from, and whose shadow maps cover it.
#pragma once

#include "engine/core/maths.h"

#include <algorithm>

namespace sunfleck::gi {

// Of a sphere about the centre of `box` that holds it, in the box's unit. At least some spacings of the box's
// coordinates, so that what has shrunk to a point is inside, wherever it is; 1 where nothing has any extent.
inline float bounding_radius(const Bounds& box) {
    if (box.empty())
        return 1.0f;
    const vec3 largest = glm::max(glm::abs(box.minimum), glm::abs(box.maximum));
    const float spacing = 0x1p-21f * std::max({largest.x, largest.y, largest.z});
    const float radius = std::max(0.5f * glm::length(box.extent()), spacing);
    return radius > 0.0f ? radius : 1.0f;
}

} // namespace sunfleck::gi

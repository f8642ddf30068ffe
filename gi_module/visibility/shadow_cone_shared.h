// Whether an object in a sphere may block light on its way to a receiver in another sphere; conservative. For shaders
// and C++.
#ifndef SUNFLECK_GI_VISIBILITY_SHADOW_CONE_SHARED_H
#define SUNFLECK_GI_VISIBILITY_SHADOW_CONE_SHARED_H
#include "engine/core/shader_language.h"
SHARED_BEGIN

// Lower bound of the distance, m, of `point` from the region that light passes through from `light` to a ball around
// `middle`: a cone that ends in the ball. 0 or less inside.
SHARED_FUNCTION float shadow_cone_distance(vec3 light, vec3 middle, float radius, vec3 point) {
    vec3 axis = middle - light;
    vec3 to_point = point - light;
    float distance = sqrt(dot(axis, axis));
    if (distance <= radius)
        return 0.0f;
    // In the plane of the axis and the point: distance from the cone's side, its apex or the ball.
    float along = dot(to_point, axis) / distance;
    float across = sqrt(max(dot(to_point, to_point) - along * along, 0.0f));
    float sine = radius / distance;
    float cosine = sqrt(1.0f - sine * sine);
    float along_side = along * cosine + across * sine;
    if (along_side < 0.0f)
        return sqrt(dot(to_point, to_point));
    if (along_side > distance * cosine) {
        vec3 from_middle = point - middle;
        return sqrt(dot(from_middle, from_middle)) - radius;
    }
    return across * cosine - along * sine;
}

SHARED_END
#endif

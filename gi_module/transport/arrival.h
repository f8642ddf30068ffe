// Irradiance of one light sample (VPL) at a point, unshadowed, on a plane that faces the light: what light_factor
// (shadows/shadowed_light.glsl) computes in the kernels, on the CPU.
#pragma once

#include "gi_module/transport/light_row.h"

#include <algorithm>

namespace sunfleck::gi {

struct Arrival {
    vec3 irradiance{0.0f}; // W/m2, on a plane that faces the light
    vec3 to_light{0.0f};   // vector to the light, m; `far` long for parallel light
};

inline Arrival arrival(const shared::LightRow& row, std::uint32_t light_class, vec3 point, float far) {
    const vec3 intensity(row.intensity_slot), axis(row.normal_offset), position(row.position_bound);
    if (light_class == shared::light_class_directional)
        return {intensity, -far * axis};
    const vec3 v = point - position;
    const float squared = std::max(glm::dot(v, v), 1e-12f), along = glm::dot(axis, v);
    if (light_class == shared::light_class_surface)
        return {intensity * std::min(std::max(along, 0.0f) / (squared * std::sqrt(squared)), row.position_bound.w), -v};
    const float cone = std::clamp(along / std::sqrt(squared) * row.tangent_scale.w + row.normal_offset.w, 0.0f, 1.0f);
    return {intensity * (cone * cone / squared), -v};
}

} // namespace sunfleck::gi

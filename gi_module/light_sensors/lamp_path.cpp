#include "gi_module/light_sensors/lamp_path.h"

#include <algorithm>
#include <cmath>

namespace sunfleck::gi {
namespace {

// A lamp that may give a sensor less than this share of its scale lights nothing that it is joined for.
constexpr float joined_share = 1e-3f;

// Of the sphere, the share that the lamp lights.
float lit_share(const Emitter& lamp) {
    return lamp.kind == EmitterKind::spot ? 0.5f * (1.0f - lamp.outer_cosine) : 1.0f;
}

} // namespace

LampChoice::LampChoice(const SensorScene& scene, vec3 sensor, float scale)
    : scene_(scene), sensor_(sensor), scale_(scale) {
    for (const Emitter& lamp : scene_.points)
        total_ += weight(lamp);
}

float LampChoice::weight(const Emitter& lamp) const {
    if (lamp.kind == EmitterKind::directional || lit_share(lamp) <= 0.0f)
        return 0.0f;
    const vec3 away = vec3(lamp.matrix[3]) - sensor_;
    const float strength = std::max({lamp.intensity.x, lamp.intensity.y, lamp.intensity.z});
    const float share = strength / (scale_ * std::max(glm::dot(away, away), 1e-30f));
    return share < joined_share ? 0.0f : std::min(share, 1.0f);
}

std::size_t LampChoice::choose(float number) const {
    float left = number * total_;
    std::size_t chosen = 0;
    for (std::size_t i = 0; i < scene_.points.size(); ++i) {
        const float one = weight(scene_.points[i]);
        if (one <= 0.0f)
            continue;
        chosen = i;
        if (left < one)
            break;
        left -= one;
    }
    return chosen;
}

float LampChoice::density(std::size_t index, vec3 place, vec3 normal) const {
    const Emitter& lamp = scene_.points[index];
    const float one = possible() ? weight(lamp) : 0.0f;
    if (one <= 0.0f)
        return 0.0f;
    const vec3 to_lamp = vec3(lamp.matrix[3]) - place;
    const float squared = std::max(glm::dot(to_lamp, to_lamp), 1e-30f);
    const float cosine = std::max(glm::dot(to_lamp, normal), 0.0f) / std::sqrt(squared);
    return one / total_ * cosine / (4.0f * pi * lit_share(lamp) * squared);
}

} // namespace sunfleck::gi

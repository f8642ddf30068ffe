#include "gi_module/light_sensors/sensor_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sunfleck::gi {

void SensorScene::take(std::vector<Emitter> emitters) {
    points.clear();
    areas.clear();
    skies.clear();
    for (Emitter& emitter : emitters) {
        std::vector<Emitter>& list = emitter.is_delta()                         ? points
                                     : emitter.kind == EmitterKind::environment ? skies
                                                                                : areas;
        list.push_back(std::move(emitter));
    }
}

EmitterReach::EmitterReach(const Emitter& emitter)
    : radius_(std::max(0.5f * std::hypot(emitter.width, emitter.height), emitter.radius)),
      everywhere_(emitter.kind == EmitterKind::directional || emitter.kind == EmitterKind::environment) {
    if (emitter.corners.empty())
        place_.add(vec3(emitter.matrix[3]));
    for (const vec3 corner : emitter.corners)
        place_.add(corner);
    const vec3 strength = emitter.is_delta() ? emitter.intensity : emitter.radiance * emitter.area;
    strength_ = std::max({strength.x, strength.y, strength.z});
}

float EmitterReach::strongest(const Bounds& box) const {
    if (everywhere_)
        return std::numeric_limits<float>::infinity();
    const vec3 apart = glm::max(vec3(0.0f), glm::max(box.minimum - place_.maximum, place_.minimum - box.maximum));
    const float distance = std::max(glm::length(apart) - radius_, 0.0f);
    return distance > 0.0f ? strength_ / (distance * distance) : std::numeric_limits<float>::infinity();
}

ArrivingLight light_from(const Emitter& emitter, const EmittedPoint& point, vec3 receiver) {
    ArrivingLight light;
    if (emitter.kind == EmitterKind::directional) {
        light.distant = true;
        light.to_light = -2.1f * emitter.scene_radius * point.normal;
        light.irradiance = emitter.intensity;
        return light;
    }
    light.to_light = point.position - receiver;
    const float squared = std::max(glm::dot(light.to_light, light.to_light), 1e-30f);
    if (emitter.kind == EmitterKind::point) {
        light.irradiance = emitter.intensity / squared;
        return light;
    }
    const float cosine = -glm::dot(light.to_light, point.normal) / std::sqrt(squared);
    if (emitter.kind == EmitterKind::spot) {
        float scale, offset;
        spot_cone(emitter, scale, offset);
        const float falloff = std::clamp(cosine * scale + offset, 0.0f, 1.0f);
        light.irradiance = emitter.intensity * (falloff * falloff / squared);
        return light;
    }
    light.irradiance = emitter.radiance * (emitter.area * std::max(cosine, 0.0f) / squared);
    return light;
}

} // namespace sunfleck::gi

#include "gi_module/light_sensors/sensor_scene.h"

#include <algorithm>
#include <cmath>

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

float strongest_irradiance(const Emitter& emitter, const Bounds& box) {
    if (emitter.kind == EmitterKind::directional || emitter.kind == EmitterKind::environment)
        return std::numeric_limits<float>::infinity();
    Bounds place;
    place.add(vec3(emitter.matrix[3]));
    for (const vec3 corner : emitter.corners)
        place.add(corner);
    const float reach = std::max(0.5f * std::hypot(emitter.width, emitter.height), emitter.radius);
    const vec3 apart = glm::max(vec3(0.0f), glm::max(box.minimum - place.maximum, place.minimum - box.maximum));
    const float distance = std::max(glm::length(apart) - reach, 0.0f), squared = distance * distance;
    const vec3 strength = emitter.is_delta() ? emitter.intensity : emitter.radiance * emitter.area;
    const float most = std::max({strength.x, strength.y, strength.z});
    return squared > 0.0f ? most / squared : std::numeric_limits<float>::infinity();
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

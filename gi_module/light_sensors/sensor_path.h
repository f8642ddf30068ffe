// One path of light to a sensor, followed backwards: from the sensor to a surface, from there to the next, and from
// each of them to emitters (next-event estimation: J. Kajiya, "The Rendering Equation", 1986), and to a surface that a
// lamp lights (lamp_path.h). The mean over a sensor's paths is the irradiance without what emitters without extent send
// straight to it, which light_of_points has exactly. What a surface reflects is taken as diffuse (mean_reflectance).
#pragma once

#include "gi_module/light_sensors/sensor_scene.h"

namespace sunfleck::gi {

// Reflections of a path at most, as the default of Settings::bounces.
inline constexpr std::uint32_t sensor_bounces = 5;

struct SensorPlace {
    vec3 position{0.0f};
    vec3 normal{0.0f, 0.0f, 1.0f};
    float scale = 1.0f; // W/m2 that matter to the sensor: emitters that may add far less are sampled more rarely
    std::uint32_t seed = 0;
};

struct SensorPath {
    vec3 light{0.0f}; // W/m2
    Bounds extent;    // of all of its rays: what moves outside of it does not change the path
    Bounds vertices;  // where emitters were sampled from
    std::uint32_t rays = 0;
};

// A pure function of its arguments. Path `index` of a sensor takes the same random numbers each time. With `reflected`
// false, its light ends at the first surface.
SensorPath follow_sensor_path(const SensorScene& scene, const SensorPlace& place, std::uint32_t index, bool reflected);

// What emitters without extent send straight to the sensor, W/m2.
vec3 light_of_points(const SensorScene& scene, const SensorPlace& place);

} // namespace sunfleck::gi

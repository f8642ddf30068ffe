// A path from a lamp without extent to the first surface that it meets. Paths of sensors are joined with it: where a
// lamp is close to a surface it lights a spot that is small and bright, which few of their own vertices find. The two
// ways to the same light are weighted by the balance heuristic (E. Veach, "Robust Monte Carlo Methods for Light
// Transport Simulation", 1997, equation 9.8; joined paths: chapter 10).
#pragma once

#include "gi_module/light_sensors/sensor_scene.h"

#include <cstddef>

namespace sunfleck::gi {

// What is visible from somewhere, of surfaces that cast shadows.
struct SensorVertex {
    vec3 position{0.0f}, normal{0.0f}; // on the side that it is seen from
    float offset = 0.0f;               // of ray origins from the surface
    // Of the position, per unit area, for a direction chosen by its cosine at the vertex before.
    float density = 0.0f;
    vec3 albedo{1.0f};
};

// Which lamp a sensor's path is joined with. Lamps that may give the sensor as much as matters to it are alike, weaker
// ones are chosen in proportion to what they may give, and never where that is too little to be noticed; nor are suns.
class LampChoice {
public:
    LampChoice(const SensorScene& scene, vec3 sensor, float scale);
    bool possible() const { return total_ > 0.0f; }
    // Of scene.points; `number` in [0, 1).
    std::size_t choose(float number) const;
    // Of the place, per unit area of a surface there, on a path that leaves the lamp by sample_emitter_ray, the choice
    // included.
    float density(std::size_t lamp, vec3 place, vec3 normal) const;

private:
    float weight(const Emitter& lamp) const;

    const SensorScene& scene_;
    vec3 sensor_;
    float scale_, total_ = 0.0f;
};

} // namespace sunfleck::gi

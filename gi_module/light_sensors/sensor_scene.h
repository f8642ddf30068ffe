// What the paths of light sensors need of a scene: rays, and the emitters by the way in which they are sampled.
#pragma once

#include "engine/raytrace/ray_scene.h"
#include "gi_module/light_sampling/emitters.h"

#include <vector>

namespace sunfleck::gi {

struct SensorScene {
    const raytrace::RayScene* rays = nullptr;
    std::vector<Emitter> points; // without extent: suns, point lights, spots
    std::vector<Emitter> areas;
    std::vector<Emitter> skies;

    // Sorts the emitters into the lists.
    void take(std::vector<Emitter> emitters);
};

// How far an emitter's light can matter.
class EmitterReach {
public:
    explicit EmitterReach(const Emitter& emitter);
    // An upper bound of the irradiance, W/m2, that the emitter can give to a surface anywhere in the box, were nothing
    // in its way. Infinite for suns and skies.
    float strongest(const Bounds& box) const;

private:
    Bounds place_;
    float radius_ = 0.0f;   // of what may stick out of the place
    float strength_ = 0.0f; // W/m2 at 1 m, at most
    bool everywhere_ = false;
};

// Light that a point on the emitter sends to a receiver, as if nothing were in its way: irradiance on a surface that
// faces it, W/m2. For area emitters the whole area's, as if all of it were where the point is.
struct ArrivingLight {
    vec3 irradiance{0.0f};
    vec3 to_light{0.0f}; // up to the emitter, or out of the scene
    bool distant = false;
};
ArrivingLight light_from(const Emitter& emitter, const EmittedPoint& point, vec3 receiver);

} // namespace sunfleck::gi

// What lights one point of a surface, and how much of its irradiance each light gives: for tools that explain a
// picture.
//
// Lights count as in the kernels (shadows/shadowed_light.glsl), but for what stands between: here a ray is traced,
// where kernels look into a shadow map. So the sum of all shares is the picture's irradiance up to the width of a map's
// texels, and up to what a technique interpolates.
#pragma once

#include "engine/raytrace/ray_scene.h"
#include "gi_module/light_sampling/sample_set.h"
#include "gi_module/transport/light_plan.h"

#include <optional>
#include <string_view>
#include <vector>

namespace sunfleck::gi {

// In the space that is lit (SceneChanges::space).
struct ReceiverPoint {
    vec3 position{0.0f};
    vec3 normal{0.0f, 1.0f, 0.0f};           // unit, that light is received by
    vec3 geometric_normal{0.0f, 1.0f, 0.0f}; // unit, on the side that is looked at
    float offset = 0.0f;                     // of rays that leave the surface, m
    bool on_mover = false;

    // `towards`: direction of the ray that met the surface.
    static ReceiverPoint of(const raytrace::SurfacePoint& surface, vec3 towards, bool on_mover);
};

struct LightShare {
    std::optional<std::uint32_t> sample; // index of the light sample; none: it is another kind of light
    ecs::Entity emitter;                 // whose light it is, reflected or not; null: not known
    std::uint32_t bounce = 0;            // reflections before it gets here
    vec3 position{0.0f};                 // of the light; of parallel light: its direction of travel
    bool parallel = false;
    vec3 unshadowed{0.0f}; // W/m2, if nothing stood between
    vec3 irradiance{0.0f}; // W/m2, that arrives
};

// What of the lighting an answer is made from; valid during the call.
struct PointQuestion {
    const ReceiverPoint& point;
    const raytrace::RayScene& rays;
    const SampleSet& samples;
    CellSet cells; // the light that is the technique's
    bool shadows = true;
};

// Of all samples whose light is in `cells` and reaches the point's side; in the order of the samples.
std::vector<LightShare> sample_shares(const PointQuestion& question);

// A technique's part of the light at a point.
struct ExplainedLight {
    std::string_view technique{};
    bool divided = false; // false: it does not say which light gives what
    std::vector<LightShare> shares{};

    vec3 sum() const;
};

} // namespace sunfleck::gi

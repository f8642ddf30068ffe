// All emitters of a registry, in one form that the samplers of VPLs and the path tracer share.
#pragma once

#include "engine/scene/components.h"
#include "engine/scene/environment_map.h"
#include "engine/scene/scene_space.h"
#include "gi_module/transport/light_sample.h"

#include <set>
#include <vector>

namespace sunfleck::gi {

enum class EmitterKind { rectangle, disc, sphere, mesh, point, spot, directional, environment };

struct Emitter {
    EmitterKind kind = EmitterKind::point;
    ecs::Entity entity;
    mat4 matrix{1.0f};                                // local to the space of the scene
    vec3 radiance{0.0f};                              // area kinds and environment, W/(sr m2)
    vec3 intensity{0.0f};                             // point and spot: W/sr; directional: irradiance W/m2
    float width = 0.0f, height = 0.0f, radius = 0.0f; // world sizes of the analytic shapes
    float area = 0.0f;                                // m2, of the area kinds
    vec3 flux{0.0f};      // W; of directional light and environment: what enters the scene's bounding sphere
    bool moves = false;   // it, or one of its parents, has a Mover
    bool is_lamp = false; // the surface of an AreaLight: views of irradiance leave it out
    float inner_cosine = 1.0f, outer_cosine = 0.0f;
    bool punctual = false;     // is_delta, and among the brightest (find_punctual)
    float scene_radius = 0.0f; // of the scene's bounding sphere, for directional light and environment
    vec3 scene_centre{0.0f};
    // Kind mesh: world-space triangles and the running sum of their areas.
    std::vector<vec3> corners; // three a triangle
    std::vector<float> cumulative_area;
    bool textured = false; // `radiance` is a mean
    bool ball = false;   // all of its surface is a sphere of `radius` about its origin: shines alike in all directions
    bool closed = false; // its surface looks to every side
    // Kind environment, with an image: `radiance` is the mean, `map_scale` multiplies the image.
    scene::EnvironmentMap map;
    vec3 map_scale{1.0f};

    vec3 environment_radiance(vec3 direction) const {
        return map.image ? map_scale * map.image->radiance(map.to_image(direction)) : radiance;
    }

    // A point or a direction (a delta distribution): one sample carries all of its light.
    bool is_delta() const {
        return kind == EmitterKind::point || kind == EmitterKind::spot || kind == EmitterKind::directional;
    }
};

// Where light leaves an emitter.
struct EmittedPoint {
    vec3 position{0.0f};
    vec3 normal{0.0f};
    // Kind mesh: the triangle and the barycentric weights of its second and third corner.
    std::uint32_t triangle = 0;
    float u = 0.0f, v = 0.0f;
};

// Emitters in ascending order of entity index. `scene`: box around all geometry. Emitters whose flux is zero, not
// finite or negative, and those of zero area, are left out; all but those of zero flux and those in `warned_of` are
// logged as a warning and put there; without it, nothing is said. Emitters of zero flux are kept if they are in
// `keep_dark`. `space`: of the results and of `scene`; where its unit is
// not 1 m, "m" is that unit, and flux and intensity are such that irradiance stays W/m2.
std::vector<Emitter> collect_emitters(ecs::Registry& registry, const scene::MeshStore& meshes, const Bounds& scene,
                                      const std::set<ecs::Entity>& keep_dark = {}, const scene::SceneSpace& space = {},
                                      std::set<ecs::Entity>* warned_of = nullptr);

// Marks the `most` brightest emitters without extent as punctual, all others as not.
void find_punctual(std::vector<Emitter>& emitters, std::uint32_t most);

// Environments that light nothing and are only seen (scene::Environment::lights), of kind environment.
std::vector<Emitter> collect_backgrounds(ecs::Registry& registry);

// Uniformly distributed over the emitter's surface (area kinds), or its position. u, v in [0, 1).
EmittedPoint sample_emitter_point(const Emitter& emitter, float u, float v);

// Cosine-weighted direction about `normal`. u, v in [0, 1).
vec3 sample_cosine_direction(vec3 normal, float u, float v);
vec3 sample_sphere_direction(float u, float v);

// A ray that leaves the emitter with a density proportional to the emitted radiance, so that all rays carry the same
// flux.
struct EmittedRay {
    vec3 origin{0.0f};
    vec3 normal{0.0f}; // of the surface at the origin, or zero
    vec3 direction{0.0f};
    // The ray carries emitter.flux * weight * tint / number of rays.
    float weight = 1.0f; // 1 except for spot lights
    vec3 tint{1.0f};     // 1 except for environments with an image, which is importance-sampled by luminance
};
EmittedRay sample_emitter_ray(const Emitter& emitter, const float numbers[4]);

// Falloff of a spot light: clamp(cos * scale + offset, 0, 1)^2, as in KHR_lights_punctual.
void spot_cone(const Emitter& emitter, float& scale, float& offset);
// Integral of that falloff over the sphere, sr.
float spot_solid_angle(const Emitter& emitter);

} // namespace sunfleck::gi

// What a light sees of the scene and how that reflects its light: a reflective shadow map (C. Dachsbacher and M.
// Stamminger, "Reflective Shadow Maps", I3D 2005), made by rays. Each texel stands for the same part of what the
// emitter emits, but for its weight: equal solid angles of a point light or a spot's cone, equal areas of a sun's disc.
// Of area lights and the sky, texels are directions, each from a place of its own.
#pragma once

#include "engine/raytrace/ray_scene.h"
#include "gi_module/light_sampling/emitters.h"
#include "gi_module/transport/pixel_light.h"

#include <optional>
#include <vector>

namespace sunfleck::gi {

struct ReflectiveTexel {
    vec3 position{0.0f};
    vec3 normal{0.0f};  // shading normal, on the lit side
    vec3 mirror{0.0f};  // direction of mirror reflection
    vec3 diffuse{0.0f}; // reflected flux, W
    vec3 glossy{0.0f};  // of it, in a lobe about `mirror`
    float exponent = 1.0f;
    float area = 0.0f; // of the surface that the texel shows, m2
    bool lit = false;  // there is a surface
    bool on_mover = false;
    ecs::Entity entity; // that the surface belongs to
    // Where on the entity: triangle, weights of its second and third corner, and whether its front is lit.
    std::uint32_t primitive = 0;
    float u = 0.0f, v = 0.0f;
    bool on_front = true;
    vec3 arriving{0.0f};              // flux, W
    bool is_glass = false;            // the surface transmits a part of it
    std::uint32_t glass_surfaces = 0; // that the light met before (refracted_light.h)
};

struct ReflectiveShadowMap {
    std::uint32_t side = 0;
    std::vector<ReflectiveTexel> texels; // row after row

    // Of the texel at a place in [0, 1)^2.
    std::size_t index(vec2 place) const {
        const auto along = [&](float x) { return std::min(std::uint32_t(x * float(side)), side - 1); };
        return std::size_t(along(place.y)) * side + along(place.x);
    }
    const ReflectiveTexel& at(vec2 place) const { return texels[index(place)]; }
};

// Which surfaces a map shows. None of them are the emitter's own.
struct MapSurfaces {
    bool fixed = true, movers = true;
};

// The first surface that casts a shadow: light passes movers that cast none, such as the glass of a lantern.
struct LitSurface {
    raytrace::Hit hit;
    raytrace::SurfacePoint point;
};
std::optional<LitSurface> lit_surface(const raytrace::RayScene& rays, raytrace::Ray ray);

// On which a texel of a map lies.
raytrace::Ray reflective_map_ray(const Emitter& emitter, std::size_t texel, std::uint32_t side,
                                 const raytrace::RayScene& rays);

// A pure function of emitter and scene. `side`: a power of two. `is_mover`: by entity.
ReflectiveShadowMap trace_reflective_map(const Emitter& emitter, std::uint32_t side, const MapSurfaces& surfaces,
                                         const raytrace::RayScene& rays, const ecs::Registry& registry);

// Of everything about an emitter that its map depends on.
std::uint64_t emitter_hash(const Emitter& emitter);

// Of the maps of so many emitters, of about `rays` texels together.
std::uint32_t reflective_map_side(std::uint32_t rays, std::size_t emitters);

// Of a texel, in a lobe or diffusely; `gloss_apart`: gloss is not diffuse.
vec3 reflected_flux(const ReflectiveTexel& texel, bool glossy, bool gloss_apart);

// The pixel light of a texel, for whoever lights by them. `texels`: it stands for so many.
PixelLight pixel_light_of(const ReflectiveTexel& texel, float texels, bool glossy, bool gloss_apart);

} // namespace sunfleck::gi

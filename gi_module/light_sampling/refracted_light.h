// What light does that meets smooth glass: it goes on through it, and leaves it elsewhere, in another direction. A
// texel of a reflective shadow map whose surface transmits light has another one of the same kind here, at the place
// where its light leaves the glass.
#pragma once

#include "gi_module/light_sampling/reflective_shadow_map.h"

namespace sunfleck::gi {

// off: light ends at glass. single: it goes straight on to the surface where it leaves the body, and is refracted
// there alone (C. Dachsbacher and M. Stamminger, "Splatting Indirect Illumination", fig. 4). traced: it is refracted by
// both surfaces of all bodies on its way, and follows total reflections within them.
enum class Refraction : std::uint32_t { off, single, traced };

// Surfaces of glass that a ray passes, or is totally reflected by, at most.
inline constexpr std::uint32_t most_glass_surfaces = 16;

// Where light leaves the last glass on its way.
struct PassedGlass {
    raytrace::SurfacePoint point;
    vec3 normal{0.0f}; // shading normal on the outer side
    vec3 direction{0.0f};
    vec3 share{1.0f};           // of its flux
    std::uint32_t surfaces = 0; // that it met
    raytrace::Hit hit;
    bool by_mover = false; // a surface on its way belongs to a mover
};

// None: the ray meets no glass, ends within it, or is lost in it. Of the light, at each surface only the brighter part
// is followed: what is refracted, unless all is reflected.
std::optional<PassedGlass> pass_glass(raytrace::Ray ray, Refraction refraction, const raytrace::RayScene& rays,
                                      const ecs::Registry& registry);

// Of an emitter's map: texels as glossy ones whose `mirror` is where the light goes. Those that are not glass are not
// lit.
ReflectiveShadowMap trace_refracted_map(const Emitter& emitter, const ReflectiveShadowMap& map, Refraction refraction,
                                        const raytrace::RayScene& rays, const ecs::Registry& registry);

} // namespace sunfleck::gi

#include "gi_module/light_sampling/refracted_light.h"

#include "engine/core/jobs.h"
#include "gi_module/light_sampling/light_sampler.h"
#include "gi_module/transport/reflectance.h"

#include <algorithm>
#include <cmath>

namespace sunfleck::gi {
namespace {

// Smooth glass: as narrow as lobes are.
constexpr float exponent_of_glass = 1e5f;

// Snell's law; `normal` against `direction`, `index`: of the far side over that of the near one. Zero: total
// reflection.
vec3 refracted(vec3 direction, vec3 normal, float index) {
    const float cosine = -glm::dot(direction, normal);
    const float squared = 1.0f - (1.0f - cosine * cosine) / (index * index);
    if (squared <= 0.0f)
        return vec3(0.0f);
    return glm::normalize(direction / index + (cosine / index - std::sqrt(squared)) * normal);
}

// Light on its way through glass.
struct Way {
    raytrace::Ray ray;
    Refraction refraction;
    PassedGlass passed;
    bool has_left = false; // it is outside again

    // At a surface of glass; false if it is lost.
    bool meet(const raytrace::SurfacePoint& point) {
        const vec3 direction = glm::normalize(ray.direction);
        const float side = glm::dot(point.geometric_normal, direction) < 0.0f ? 1.0f : -1.0f;
        const bool entering = side > 0.0f;
        const vec3 normal = side * point.shading_normal;
        const float outer = point.material.index_of_refraction, index = entering ? outer : 1.0f / outer;
        const float cosine = -glm::dot(direction, normal);
        if (cosine <= 0.0f)
            return false; // the shading normal says that it comes from the other side
        vec3 onwards = refracted(direction, normal, index);
        has_left = false;
        if (onwards == vec3(0.0f)) {
            onwards = direction + 2.0f * cosine * normal;
        } else {
            passed.share *=
                (1.0f - fresnel_dielectric(cosine, index)) * point.material.transmission * point.material.base_colour;
            if (entering && refraction == Refraction::single)
                onwards = direction;
            has_left = !entering;
        }
        const float towards = glm::dot(onwards, side * point.geometric_normal);
        if ((towards < 0.0f) != (has_left || entering))
            return false; // by the triangle it is on the other side
        ray.direction = onwards;
        ray.origin = point.on_triangle + (towards < 0.0f ? -side : side) * point.offset * point.geometric_normal;
        passed.point = point;
        passed.normal = -normal;
        passed.direction = onwards;
        ++passed.surfaces;
        return true;
    }
};

} // namespace

std::optional<PassedGlass> pass_glass(raytrace::Ray ray, Refraction refraction, const raytrace::RayScene& rays,
                                      const ecs::Registry& registry) {
    Way way{ray, refraction, {}};
    while (way.passed.surfaces < most_glass_surfaces && !(way.has_left && refraction == Refraction::single)) {
        const std::optional<LitSurface> met = lit_surface(rays, way.ray);
        if (!met || met->point.material.transmission <= 0.0f)
            break;
        way.passed.by_mover = way.passed.by_mover || !scene::is_static(registry, met->point.entity);
        way.passed.hit = met->hit;
        if (!way.meet(met->point))
            return std::nullopt;
    }
    return way.has_left ? std::optional(way.passed) : std::nullopt;
}

ReflectiveShadowMap trace_refracted_map(const Emitter& emitter, const ReflectiveShadowMap& map, Refraction refraction,
                                        const raytrace::RayScene& rays, const ecs::Registry& registry) {
    ReflectiveShadowMap result;
    result.side = map.side;
    result.texels.resize(map.texels.size());
    parallel_for_chunks(map.texels.size(), 256, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const ReflectiveTexel& at = map.texels[i];
            if (!at.is_glass)
                continue;
            const std::optional<PassedGlass> passed =
                pass_glass(reflective_map_ray(emitter, i, map.side, rays), refraction, rays, registry);
            if (!passed)
                continue;
            ReflectiveTexel& texel = result.texels[i];
            texel.lit = true;
            texel.position =
                offset_from_surface(passed->point.position, passed->normal, rays, raytrace::Scope::everything);
            texel.normal = passed->normal;
            texel.mirror = passed->direction;
            texel.glossy = at.arriving * passed->share;
            texel.exponent = exponent_of_glass;
            texel.area = at.area;
            texel.on_mover = passed->by_mover;
            texel.entity = passed->point.entity;
            texel.primitive = passed->hit.primitive;
            texel.u = passed->hit.u;
            texel.v = passed->hit.v;
            texel.on_front = true;
            texel.glass_surfaces = passed->surfaces;
        }
    });
    return result;
}

} // namespace sunfleck::gi

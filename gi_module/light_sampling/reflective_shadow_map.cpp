#include "gi_module/light_sampling/reflective_shadow_map.h"

#include "engine/core/hash.h"
#include "engine/core/jobs.h"
#include "gi_module/light_sampling/light_sampler.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace sunfleck::gi {
namespace {

constexpr std::uint32_t least_side = 4, greatest_side = 1024; // texels of a map
constexpr float least_cosine = 0.05f;                         // of incidence, for the area that a texel shows

// Of the R2 sequence (M. Roberts): places on area lights and the sky's disc, which texels of a map share evenly.
vec2 spread_place(std::uint32_t index) {
    const double x = 0.5 + 0.7548776662466927 * index, y = 0.5 + 0.5698402909980532 * index;
    return {float(x - std::floor(x)), float(y - std::floor(y))};
}

EmittedRay ray_of(const Emitter& emitter, std::uint32_t x, std::uint32_t y, std::uint32_t side) {
    const vec2 texel((float(x) + 0.5f) / float(side), (float(y) + 0.5f) / float(side));
    const vec2 spread = spread_place(y * side + x);
    const bool parallel = emitter.kind == EmitterKind::directional;
    const vec2 place = parallel ? texel : spread, direction = parallel ? spread : texel;
    const float numbers[4] = {place.x, place.y, direction.x, direction.y};
    return sample_emitter_ray(emitter, numbers);
}

// Area that a texel would show of a facing surface, m2.
float facing_area(const Emitter& emitter, float distance, std::uint32_t texels) {
    float all = 4.0f * pi * distance * distance;
    if (emitter.kind == EmitterKind::directional)
        all = pi * emitter.scene_radius * emitter.scene_radius;
    else if (emitter.kind == EmitterKind::spot)
        all *= 0.5f * (1.0f - emitter.outer_cosine);
    else if (emitter.kind != EmitterKind::point && emitter.kind != EmitterKind::environment)
        all = std::max(0.5f * all, 0.0f) + emitter.area;
    return all / float(texels);
}

raytrace::Ray ray_from(const EmittedRay& emitted, const raytrace::RayScene& rays) {
    const float offset = emitted.normal == vec3(0.0f) ? 0.0f : rays.ray_offset_anywhere();
    return {emitted.origin + offset * emitted.normal, emitted.direction, 0.0f, 1e30f};
}

struct Tracer {
    const Emitter& emitter;
    const MapSurfaces& surfaces;
    const raytrace::RayScene& rays;
    const ecs::Registry& registry;
    std::uint32_t side;

    ReflectiveTexel texel(std::uint32_t x, std::uint32_t y) const {
        ReflectiveTexel texel;
        const EmittedRay emitted = ray_of(emitter, x, y, side);
        const raytrace::Ray ray = ray_from(emitted, rays);
        const std::optional<LitSurface> met = lit_surface(rays, ray);
        if (!met)
            return texel;
        const raytrace::SurfacePoint& point = met->point;
        texel.on_mover = !scene::is_static(registry, point.entity);
        if (point.entity == emitter.entity || !(texel.on_mover ? surfaces.movers : surfaces.fixed))
            return texel;
        const float lit_side = glm::dot(point.geometric_normal, ray.direction) < 0.0f ? 1.0f : -1.0f;
        texel.lit = true;
        texel.entity = point.entity;
        texel.primitive = met->hit.primitive;
        texel.u = met->hit.u;
        texel.v = met->hit.v;
        texel.on_front = lit_side > 0.0f;
        texel.position =
            offset_from_surface(point.position, lit_side * point.geometric_normal, rays, raytrace::Scope::everything);
        texel.normal = lit_side * point.shading_normal;
        const float cosine = std::clamp(-glm::dot(texel.normal, ray.direction), 0.0f, 1.0f);
        texel.mirror = glm::normalize(ray.direction + 2.0f * cosine * texel.normal);
        const LobeReflectance lobes = lobe_reflectance(point.material, cosine);
        const std::uint32_t texels = side * side;
        texel.arriving = emitter.flux * emitted.weight * emitted.tint / float(texels);
        texel.is_glass = point.material.transmission > 0.0f;
        texel.diffuse = texel.arriving * lobes.diffuse;
        texel.glossy = texel.arriving * lobes.glossy;
        texel.exponent = lobes.exponent;
        const float distance = glm::length(point.position - ray.origin);
        texel.area = facing_area(emitter, distance, texels) / std::max(cosine, least_cosine);
        return texel;
    }
};

} // namespace

std::optional<LitSurface> lit_surface(const raytrace::RayScene& rays, raytrace::Ray ray) {
    while (const auto hit = rays.closest_hit(ray)) {
        const raytrace::SurfacePoint point = rays.surface(ray, *hit);
        if (point.casts_shadow)
            return LitSurface{*hit, point};
        ray.minimum = hit->distance * (1.0f + 0x1p-17f);
    }
    return std::nullopt;
}

raytrace::Ray reflective_map_ray(const Emitter& emitter, std::size_t texel, std::uint32_t side,
                                 const raytrace::RayScene& rays) {
    return ray_from(ray_of(emitter, std::uint32_t(texel % side), std::uint32_t(texel / side), side), rays);
}

ReflectiveShadowMap trace_reflective_map(const Emitter& emitter, std::uint32_t side, const MapSurfaces& surfaces,
                                         const raytrace::RayScene& rays, const ecs::Registry& registry) {
    ReflectiveShadowMap map;
    map.side = side;
    map.texels.resize(std::size_t(side) * side);
    const Tracer tracer{emitter, surfaces, rays, registry, side};
    parallel_for_chunks(side, 4, [&](std::size_t begin, std::size_t end) {
        for (std::size_t y = begin; y < end; ++y)
            for (std::uint32_t x = 0; x < side; ++x)
                map.texels[y * side + x] = tracer.texel(x, std::uint32_t(y));
    });
    return map;
}

std::uint64_t emitter_hash(const Emitter& emitter) {
    std::uint64_t hash = hash_start;
    const auto add = [&](const auto& value) { hash = hash_bytes(hash, &value, sizeof value); };
    add(emitter.matrix);
    add(emitter.flux);
    add(emitter.width);
    add(emitter.height);
    add(emitter.radius);
    add(emitter.area);
    add(emitter.inner_cosine);
    add(emitter.outer_cosine);
    add(emitter.scene_radius);
    add(emitter.scene_centre);
    add(emitter.map.rotation);
    return hash_bytes(hash, emitter.corners.data(), emitter.corners.size() * sizeof(vec3));
}

std::uint32_t reflective_map_side(std::uint32_t rays, std::size_t emitters) {
    const double texels = double(rays) / double(std::max<std::size_t>(emitters, 1));
    return std::clamp(std::bit_floor(std::uint32_t(std::sqrt(texels))), least_side, greatest_side);
}

vec3 reflected_flux(const ReflectiveTexel& texel, bool glossy, bool gloss_apart) {
    if (glossy)
        return texel.glossy;
    return gloss_apart ? texel.diffuse : texel.diffuse + texel.glossy;
}

PixelLight pixel_light_of(const ReflectiveTexel& texel, float texels, bool glossy, bool gloss_apart) {
    PixelLight light;
    light.position = texel.position;
    light.normal = texel.normal;
    light.axis = glossy ? texel.mirror : texel.normal;
    light.exponent = glossy ? texel.exponent : 1.0f;
    light.flux = texels * reflected_flux(texel, glossy, gloss_apart);
    light.area = texels * texel.area;
    return light;
}

} // namespace sunfleck::gi

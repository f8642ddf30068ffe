#include "gi_module/light_sensors/sensor_path.h"

#include "engine/core/random.h"
#include "gi_module/light_sensors/lamp_path.h"
#include "gi_module/transport/reflectance.h"

#include <algorithm>
#include <optional>

namespace sunfleck::gi {
namespace {

// Emitters that may add less than this share of the sensor's scale are sampled by chance (Russian roulette), in
// proportion to what they may add.
constexpr float certain_share = 0.1f;
constexpr std::uint32_t roulette_start = 1;        // reflections after which paths may end
constexpr std::uint32_t dimensions_per_vertex = 8; // direction: 2, roulette: 1, choice of area: 1, place on it: 2
constexpr int most_layers = 64;                    // of surfaces without shadow, one behind another

float largest(vec3 colour) {
    return std::max({colour.x, colour.y, colour.z});
}

using Vertex = SensorVertex;

// The first surface on a path from a lamp.
struct LitVertex {
    Vertex vertex;
    vec3 radiance{0.0f}; // reflected to all sides, W/(m2 sr)
    float density = 0.0f;
    std::uint32_t lamp = 0; // its entity's index
    bool found = false;
};

// True if nothing is between the vertex and the light.
bool sees(const raytrace::RayScene& rays, const Vertex& vertex, const ArrivingLight& light) {
    const vec3 origin = vertex.position + vertex.offset * vertex.normal;
    const vec3 way = light.distant ? light.to_light : vertex.position + light.to_light - origin;
    // Up to the emitter's own surface, as closely as floats know where it is.
    const float left_out = light.distant ? 0.0f : rays.ray_offset_anywhere() / glm::length(way);
    return !rays.occluded(raytrace::Ray{origin, way, 0.0f, 1.0f - std::max(left_out, 0x1p-20f)});
}

class Walk {
public:
    Walk(const SensorScene& scene, const SensorPlace& place, std::uint32_t index)
        : scene_(scene), place_(place), index_(index), random_(SequenceKind::sobol, place.seed, index),
          lamps_(scene, place.position, place.scale) {}

    SensorPath follow(bool reflected) {
        Vertex vertex{place_.position, place_.normal, scene_.rays->ray_offset_anywhere()};
        if (reflected && lamps_.possible())
            follow_lamp();
        for (std::uint32_t reflections = 0;; ++reflections) {
            visit(vertex.position);
            path_.vertices.add(vertex.position);
            random_.seek(reflections * dimensions_per_vertex);
            const float u = random_.next(), v = random_.next(), survival = random_.next();
            if (reflections > 0)
                add_points(vertex, reflections);
            add_area(vertex);
            if (reflections < sensor_bounces)
                join(vertex, reflections);
            if (reflections == sensor_bounces || !advance(vertex, sample_cosine_direction(vertex.normal, u, v)))
                break;
            if (!reflected || !survives(vertex, reflections, survival))
                break;
        }
        return path_;
    }

private:
    void visit(vec3 point) { path_.extent.add(point); }

    bool survives(const Vertex& vertex, std::uint32_t reflections, float number) {
        if (reflections < roulette_start)
            return true;
        const float chance = std::clamp(largest(vertex.albedo), 0.05f, 0.98f);
        throughput_ /= chance;
        return number < chance;
    }

    // Adds light, W/m2 at the vertex with its cosine, that an emitter sends if it is seen.
    void add(const Vertex& vertex, const ArrivingLight& light, float weight, float number) {
        const float length = glm::length(light.to_light);
        const float cosine = length > 0.0f ? glm::dot(light.to_light, vertex.normal) / length : 0.0f;
        const vec3 most = throughput_ * light.irradiance * (weight * std::max(cosine, 0.0f));
        const float share = largest(most) / (certain_share * place_.scale), chance = std::min(share, 1.0f);
        if (number >= chance)
            return;
        ++path_.rays;
        visit(vertex.position + light.to_light);
        if (sees(*scene_.rays, vertex, light))
            path_.light += most / chance;
    }

    void add_points(const Vertex& vertex, std::uint32_t reflections) {
        for (std::size_t i = 0; i < scene_.points.size(); ++i) {
            const Emitter& emitter = scene_.points[i];
            const float joined = lamps_.density(i, vertex.position, vertex.normal);
            const float weight = joined > 0.0f ? vertex.density / (vertex.density + joined) : 1.0f;
            add(vertex, light_from(emitter, sample_emitter_point(emitter, 0.0f, 0.0f), vertex.position), weight,
                number(reflections, emitter.entity.index));
        }
    }

    float number(std::uint32_t reflections, std::uint32_t salt) const {
        return to_unit_float(hash_combine(hash_combine(place_.seed, index_), hash_combine(reflections, salt)));
    }

    void follow_lamp() {
        random_.seek((sensor_bounces + 1) * dimensions_per_vertex);
        const std::size_t chosen = lamps_.choose(random_.next());
        const Emitter& lamp = scene_.points[chosen];
        const float u = random_.next(), v = random_.next(), numbers[4] = {0.0f, 0.0f, u, v};
        const EmittedRay emitted = sample_emitter_ray(lamp, numbers);
        path_.vertices.add(emitted.origin); // whenever the lamp changes, so does the path
        visit(emitted.origin);
        const std::optional<Vertex> met = surface_along(emitted.origin, emitted.direction);
        visit(met ? met->position : emitted.origin + 1e6f * emitted.direction); // as in advance
        if (!met || largest(met->albedo) <= 0.0f)
            return;
        const ArrivingLight light = light_from(lamp, sample_emitter_point(lamp, 0.0f, 0.0f), met->position);
        const float cosine = glm::dot(glm::normalize(light.to_light), met->normal);
        lit_ = {*met, met->albedo * light.irradiance * (std::max(cosine, 0.0f) / pi),
                lamps_.density(chosen, met->position, met->normal), lamp.entity.index, true};
    }

    // Adds what the vertex gets from the surface that the lamp lights, weighted against that the next vertex lies
    // there.
    void join(const Vertex& vertex, std::uint32_t reflections) {
        if (!lit_.found || lit_.density <= 0.0f)
            return;
        const vec3 way = lit_.vertex.position - vertex.position;
        const float squared = glm::dot(way, way), length = std::sqrt(squared);
        const float here = glm::dot(way, vertex.normal), there = -glm::dot(way, lit_.vertex.normal);
        if (here <= 0.0f || there <= 0.0f)
            return;
        const float cosines = here * there / squared;
        ArrivingLight light;
        light.irradiance = lit_.radiance * (there / length / (cosines / pi + lit_.density * squared));
        light.to_light = way;
        add(vertex, light, 1.0f, number(reflections, ~lit_.lamp));
    }

    // About the irradiance that the emitter gives to a place, were nothing in its way.
    static float importance(const Emitter& emitter, vec3 receiver) {
        const vec3 centre = emitter.corners.empty() ? vec3(emitter.matrix[3]) : emitter.corners.front();
        const vec3 away = centre - receiver;
        return luminance(emitter.radiance) * emitter.area / (glm::dot(away, away) + emitter.area);
    }

    void add_area(const Vertex& vertex) {
        if (scene_.areas.empty())
            return;
        float total = 0.0f;
        for (const Emitter& emitter : scene_.areas)
            total += importance(emitter, vertex.position);
        float number = random_.next() * total, chance = 0.0f;
        std::size_t chosen = 0;
        for (;; ++chosen) {
            chance = importance(scene_.areas[chosen], vertex.position);
            if (number < chance || chosen + 1 == scene_.areas.size())
                break;
            number -= chance;
        }
        if (chance <= 0.0f)
            return;
        const Emitter& emitter = scene_.areas[chosen];
        const float u = random_.next(), v = random_.next();
        // What is left of the number that chose is as good as a new one.
        add(vertex, light_from(emitter, sample_emitter_point(emitter, u, v), vertex.position), total / chance,
            std::min(number / chance, 0x1.fffffep-1f));
    }

    // To the surface in this direction; false if there is none, or it ends the path.
    bool advance(Vertex& vertex, vec3 direction) {
        const vec3 from = vertex.position, origin = from + vertex.offset * vertex.normal;
        const float density = glm::dot(direction, vertex.normal) / pi;
        const std::optional<Vertex> met = surface_along(origin, direction);
        if (!met) {
            for (const Emitter& sky : scene_.skies)
                path_.light += throughput_ * pi * sky.environment_radiance(direction);
            path_.extent.add(from + 1e6f * direction);
            return false;
        }
        vertex = *met;
        const vec3 way = vertex.position - from;
        const float squared = std::max(glm::dot(way, way), 1e-30f);
        vertex.density = std::max(density * -glm::dot(direction, vertex.normal) / squared, 0.0f);
        throughput_ *= vertex.albedo;
        return largest(vertex.albedo) > 0.0f;
    }

    // Light passes what casts no shadow.
    std::optional<Vertex> surface_along(vec3 origin, vec3 direction) {
        raytrace::Ray ray{origin, direction, 0.0f, 1e30f, index_};
        for (int layer = 0; layer < most_layers; ++layer) {
            ++path_.rays;
            const auto hit = scene_.rays->closest_hit(ray);
            if (!hit)
                return std::nullopt;
            const raytrace::SurfacePoint point = scene_.rays->surface(ray, *hit);
            const bool front = glm::dot(point.geometric_normal, direction) < 0.0f;
            const vec3 normal = front ? point.geometric_normal : -point.geometric_normal;
            if (point.casts_shadow)
                return Vertex{point.on_triangle, normal, point.offset, 0.0f, mean_reflectance(point.material)};
            ray.origin = point.on_triangle - point.offset * normal;
        }
        return std::nullopt;
    }

    const SensorScene& scene_;
    const SensorPlace& place_;
    std::uint32_t index_;
    RandomSequence random_;
    LampChoice lamps_;
    LitVertex lit_;
    vec3 throughput_{1.0f};
    SensorPath path_;
};

} // namespace

SensorPath follow_sensor_path(const SensorScene& scene, const SensorPlace& place, std::uint32_t index, bool reflected) {
    return Walk(scene, place, index).follow(reflected);
}

vec3 light_of_points(const SensorScene& scene, const SensorPlace& place) {
    const Vertex vertex{place.position, place.normal, scene.rays->ray_offset_anywhere()};
    vec3 sum(0.0f);
    for (const Emitter& emitter : scene.points) {
        const ArrivingLight light = light_from(emitter, sample_emitter_point(emitter, 0.0f, 0.0f), vertex.position);
        const float length = glm::length(light.to_light);
        const float cosine = length > 0.0f ? glm::dot(light.to_light, vertex.normal) / length : 0.0f;
        if (cosine > 0.0f && largest(light.irradiance) > 0.0f && sees(*scene.rays, vertex, light))
            sum += light.irradiance * cosine;
    }
    return sum;
}

} // namespace sunfleck::gi

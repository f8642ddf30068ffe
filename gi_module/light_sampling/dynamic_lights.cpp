#include "gi_module/light_sampling/dynamic_lights.h"

#include "gi_module/light_sampling/light_sampler.h"
#include "gi_module/transport/reflectance.h"

#include "engine/core/random.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace sunfleck::gi {
namespace {

constexpr std::uint32_t direction_count = 512;
constexpr float segment_margin = 2e-3f;    // m, off the emitter and the first surface
constexpr float far_away = 1e4f;           // m
constexpr std::uint32_t max_resampled = 4; // per light and frame
constexpr float max_cell = 3.0f;           // times the mean: a path with a small cell moves into a larger one

mat3 rotation_of(const mat4& matrix) {
    mat3 result(matrix);
    for (int i = 0; i < 3; ++i)
        result[i] /= std::max(glm::length(result[i]), 1e-30f);
    return result;
}

bool emits_towards(const Emitter& emitter, vec3 normal, vec3 direction) {
    if (emitter.kind == EmitterKind::point)
        return true;
    if (emitter.kind == EmitterKind::spot)
        return glm::dot(direction, sample_emitter_point(emitter, 0.5f, 0.5f).normal) > emitter.outer_cosine;
    return glm::dot(direction, normal) > 0.0f;
}

} // namespace

void DynamicLights::reset(const std::vector<Emitter>& emitters, std::uint32_t count, const SampleRequest& settings,
                          const raytrace::RayScene& rays) {
    settings_ = settings;
    lights_.clear();
    samples_.clear();
    moved_.clear();
    resampled_ = paths_made_ = 0;
    if (emitters.empty() || (!settings.direct && !(settings.indirect && settings.bounces > 0)))
        return;
    std::vector<double> weights;
    for (const Emitter& emitter : emitters)
        weights.push_back(std::max(double(luminance(emitter.flux)), 1e-6));
    const std::vector<std::uint32_t> counts =
        apportion(weights, std::max<std::uint32_t>(count, std::uint32_t(emitters.size())));
    for (std::size_t e = 0; e < emitters.size(); ++e)
        add_light(emitters[e], std::uint32_t(e), counts[e], rays);
    moved_.assign(samples_.size(), 1);
}

// `count`: samples on the emitter and of its paths.
void DynamicLights::add_light(const Emitter& emitter, std::uint32_t number, std::uint32_t count,
                              const raytrace::RayScene& rays) {
    const bool indirect = settings_.indirect && settings_.bounces > 0;
    Light light;
    light.emitter = emitter;
    light.first = std::uint32_t(samples_.size());
    if (settings_.direct && emitter.is_delta())
        light.direct = 1;
    else if (settings_.direct)
        light.direct = indirect ? std::max(1u, std::uint32_t(float(count) * settings_.direct_share)) : count;
    const std::uint32_t paths = indirect ? count - std::min(light.direct, count) : 0;
    light.paths.resize(paths);
    make_directions(light, hash_combine(settings_.seed, 0xd1a0u + number));
    samples_.resize(samples_.size() + light.direct + paths);
    place_direct(light, rays);
    fill_gaps(light, paths, rays);
    share_flux(light);
    lights_.push_back(std::move(light));
}

void DynamicLights::update(const std::vector<Emitter>& emitters, const raytrace::RayScene& rays) {
    moved_.assign(samples_.size(), 0);
    resampled_ = 0;
    for (std::size_t e = 0; e < lights_.size(); ++e) {
        Light& light = lights_[e];
        const bool still = light.emitter.matrix == emitters[e].matrix;
        const bool complete =
            std::all_of(light.paths.begin(), light.paths.end(), [](const Path& p) { return p.valid; });
        if (still && complete && light.emitter.flux == emitters[e].flux)
            continue;
        light.emitter = emitters[e];
        place_direct(light, rays);
        if (!still)
            validate(light, rays);
        if (!still || !complete)
            fill_gaps(light, max_resampled, rays);
        share_flux(light);
    }
}

void DynamicLights::make_directions(Light& light, std::uint32_t seed) const {
    const mat3 to_local = glm::transpose(rotation_of(light.emitter.matrix));
    for (std::uint32_t i = 0; i < direction_count; ++i) {
        const RandomSequence random(SequenceKind::sobol, seed, i);
        const std::array<float, 4> numbers = {random.at(0), random.at(1), random.at(2), random.at(3)};
        const EmittedRay ray = sample_emitter_ray(light.emitter, numbers.data());
        light.directions.push_back(to_local * ray.direction);
        light.weights.push_back(ray.weight);
        light.numbers.push_back(numbers);
    }
}

void DynamicLights::place_direct(Light& light, const raytrace::RayScene& rays) {
    for (std::uint32_t i = 0; i < light.direct; ++i) {
        LightSample sample = make_direct_sample(light.emitter, i, light.direct, settings_, rays);
        sample.dynamic = true;
        LightSample& old = samples_[light.first + i];
        const bool same_cone = sample.cone_scale == old.cone_scale && sample.cone_offset == old.cone_offset;
        if (!moved_.empty() && (sample.position != old.position || sample.normal != old.normal || !same_cone))
            moved_[light.first + i] = 1;
        old = sample;
    }
}

// Which first segments are still unoccluded, and their directions as seen from the emitter.
void DynamicLights::validate(Light& light, const raytrace::RayScene& rays) const {
    const mat3 to_local = glm::transpose(rotation_of(light.emitter.matrix));
    for (Path& path : light.paths) {
        const EmittedRay emitted = sample_emitter_ray(light.emitter, path.numbers);
        const vec3 origin = emitted.origin + segment_margin * emitted.normal;
        const vec3 segment = path.first_hit - origin;
        const float length = glm::length(segment);
        const vec3 direction = segment / std::max(length, 1e-6f);
        path.direction = to_local * direction;
        path.valid = path.valid && length > 2.0f * segment_margin &&
                     emits_towards(light.emitter, emitted.normal, direction) &&
                     !rays.occluded(raytrace::Ray{origin, direction, 0.0f, length - segment_margin},
                                    raytrace::Scope::static_only);
    }
}

void DynamicLights::sample_path(Light& light, std::uint32_t index, const raytrace::RayScene& rays) {
    Path& path = light.paths[index];
    LightSample& sample = samples_[light.first + light.direct + index];
    const EmittedRay emitted = sample_emitter_ray(light.emitter, path.numbers);
    path.throughput = vec3(1.0f);
    path.escaped = false;
    path.valid = true;
    trace_path(path, sample, {emitted.origin + segment_margin * emitted.normal, emitted.direction, 0.0f, 1e30f}, rays);
    if (path.escaped) {
        sample.position = emitted.origin;
        sample.normal = emitted.direction;
        sample.bounce = 1;
    }
    sample.kind = SampleKind::surface;
    sample.emitter = light.emitter.entity;
    sample.dynamic = true;
    if (!moved_.empty())
        moved_[light.first + light.direct + index] = 1;
    ++resampled_;
}

// A random walk from the emitted ray; the sample lies where it ends.
void DynamicLights::trace_path(Path& path, LightSample& sample, raytrace::Ray ray, const raytrace::RayScene& rays) {
    const std::uint32_t seed = hash_combine(settings_.seed, 0x9a7u);
    RandomSequence random(SequenceKind::pseudo_random, seed, paths_made_++);
    for (std::uint32_t bounce = 1; bounce <= settings_.bounces; ++bounce) {
        const auto hit = rays.closest_hit(ray, raytrace::Scope::static_only);
        if (!hit) {
            path.escaped = bounce == 1;
            path.throughput = vec3(0.0f);
            break;
        }
        const raytrace::SurfacePoint point = rays.surface(ray, *hit);
        const float side = glm::dot(point.geometric_normal, ray.direction) < 0.0f ? 1.0f : -1.0f;
        const vec3 normal = side * point.geometric_normal, shading = side * point.shading_normal;
        if (bounce == 1)
            path.first_hit = point.position;
        const vec3 albedo = mean_reflectance(point.material);
        path.throughput *= albedo;
        sample.position = offset_from_surface(point.position, normal, rays, raytrace::Scope::static_only);
        sample.normal = shading;
        sample.bounce = bounce;
        // The throughput of a path is nearly the same wherever it ends, within limits: no sample outshines the others.
        const float largest = std::max({albedo.x, albedo.y, albedo.z});
        const float stop = bounce == settings_.bounces ? 1.0f : std::clamp(1.0f - largest, 0.35f, 0.8f);
        const float u = random.next(), v = random.next();
        if (random.next() < stop) {
            path.throughput /= stop;
            break;
        }
        path.throughput /= 1.0f - stop;
        ray = {point.position + 1e-4f * normal, sample_cosine_direction(shading, u, v), 0.0f, 1e30f};
    }
    if (path.escaped)
        path.first_hit = ray.origin + far_away * ray.direction;
}

// The directions of a light, by the valid path that each is nearest to.
struct DynamicLights::Cells {
    explicit Cells(const Light& light) : nearest(light.directions.size(), -2.0f), owner(light.directions.size(), 0) {}

    std::vector<float> nearest; // largest cosine to any path
    std::vector<std::uint32_t> owner;

    void add(const Light& light, std::uint32_t path) {
        for (std::size_t d = 0; d < light.directions.size(); ++d)
            if (const float cosine = glm::dot(light.paths[path].direction, light.directions[d]); cosine > nearest[d]) {
                nearest[d] = cosine;
                owner[d] = path;
            }
    }

    // The path with the smallest cell, if the largest is much larger than the mean.
    std::optional<std::uint32_t> most_crowded(const Light& light) const {
        std::vector<float> cells(light.paths.size(), 0.0f);
        for (std::size_t d = 0; d < owner.size(); ++d)
            cells[owner[d]] += light.weights[d];
        const auto [smallest, largest] = std::minmax_element(cells.begin(), cells.end());
        if (*largest * float(light.paths.size()) < max_cell * float(light.directions.size()))
            return std::nullopt;
        return std::uint32_t(smallest - cells.begin());
    }

    std::size_t largest_gap() const {
        return std::size_t(std::min_element(nearest.begin(), nearest.end()) - nearest.begin());
    }
};

// Invalid paths are sampled again, at most `count` of them, in the middle of the largest gaps between the others. When
// all are valid, but a gap is much larger than the rest, the path with the smallest cell moves there.
void DynamicLights::fill_gaps(Light& light, std::uint32_t count, const raytrace::RayScene& rays) {
    if (light.paths.empty())
        return;
    Cells cells(light);
    std::vector<std::uint32_t> chosen;
    for (std::uint32_t p = 0; p < light.paths.size(); ++p) {
        if (light.paths[p].valid)
            cells.add(light, p);
        else
            chosen.push_back(p);
    }
    if (chosen.empty()) {
        const std::optional<std::uint32_t> moved = cells.most_crowded(light);
        if (!moved)
            return;
        chosen.push_back(*moved);
    }
    chosen.resize(std::min<std::size_t>(chosen.size(), count));
    for (const std::uint32_t p : chosen) {
        const std::size_t gap = cells.largest_gap();
        std::copy(light.numbers[gap].begin(), light.numbers[gap].end(), light.paths[p].numbers);
        light.paths[p].direction = light.directions[gap];
        sample_path(light, p, rays);
        cells.add(light, p);
    }
}

void DynamicLights::share_flux(Light& light) {
    std::vector<float> cells(light.paths.size(), 0.0f);
    float total = 0.0f;
    for (std::size_t d = 0; d < light.directions.size(); ++d) {
        std::size_t owner = light.paths.size();
        float nearest = -2.0f;
        for (std::size_t p = 0; p < light.paths.size(); ++p)
            if (const float cosine = glm::dot(light.paths[p].direction, light.directions[d]);
                light.paths[p].valid && cosine > nearest) {
                nearest = cosine;
                owner = p;
            }
        total += light.weights[d];
        if (owner < light.paths.size())
            cells[owner] += light.weights[d];
    }
    for (std::size_t p = 0; p < light.paths.size(); ++p)
        samples_[light.first + light.direct + p].flux =
            total > 0.0f ? light.emitter.flux * light.paths[p].throughput * (cells[p] / total) : vec3(0.0f);
}

} // namespace sunfleck::gi

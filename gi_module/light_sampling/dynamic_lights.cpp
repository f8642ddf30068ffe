#include "gi_module/light_sampling/dynamic_lights.h"

#include "gi_module/light_sampling/light_sampler.h"

#include "engine/core/random.h"

#include <algorithm>
#include <cmath>

namespace sunfleck::gi {
namespace {

constexpr std::uint32_t direction_count = 512;
constexpr float leg_margin = 2e-3f;            // m, before the first surface
constexpr float far_away = 1e4f;               // m
constexpr std::uint32_t resampled_at_once = 4; // a light and frame
constexpr float worst_cell = 3.0f;             // times the mean: a path moves there from where cells are smallest

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

void DynamicLights::reset(const std::vector<Emitter>& emitters, std::uint32_t count, const Settings& settings,
                          const raytrace::RayScene& rays) {
    settings_ = settings;
    lights_.clear();
    samples_.clear();
    moved_.clear();
    resampled_ = paths_made_ = 0;
    const bool direct = settings.direct != DirectTechnique::none;
    const bool indirect = settings.indirect != IndirectTechnique::none && settings.bounces > 0;
    if (emitters.empty() || (!direct && !indirect))
        return;
    std::vector<double> weights;
    for (const Emitter& emitter : emitters)
        weights.push_back(std::max(double(luminance(emitter.flux)), 1e-6));
    const std::vector<std::uint32_t> counts =
        apportion(weights, std::max<std::uint32_t>(count, std::uint32_t(emitters.size())));
    for (std::size_t e = 0; e < emitters.size(); ++e) {
        Light light;
        light.emitter = emitters[e];
        light.first = std::uint32_t(samples_.size());
        if (direct && emitters[e].is_delta())
            light.direct = 1;
        else if (direct)
            light.direct = indirect ? std::max(1u, std::uint32_t(float(counts[e]) * settings.direct_share)) : counts[e];
        const std::uint32_t paths = indirect ? counts[e] - std::min(light.direct, counts[e]) : 0;
        light.paths.resize(paths);
        make_directions(light, hash_combine(settings.seed, 0xd1a0u + std::uint32_t(e)));
        samples_.resize(samples_.size() + light.direct + paths);
        place_direct(light, rays);
        fill_gaps(light, paths, rays);
        share_flux(light);
        lights_.push_back(std::move(light));
    }
    moved_.assign(samples_.size(), 1);
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
            fill_gaps(light, resampled_at_once, rays);
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

// Which first legs the emitter still sees, and where they lead as seen from it.
void DynamicLights::validate(Light& light, const raytrace::RayScene& rays) const {
    const mat3 to_local = glm::transpose(rotation_of(light.emitter.matrix));
    for (Path& path : light.paths) {
        const EmittedRay emitted = sample_emitter_ray(light.emitter, path.numbers);
        const vec3 origin = emitted.origin + leg_margin * emitted.normal;
        const vec3 leg = path.first_hit - origin;
        const float length = glm::length(leg);
        const vec3 direction = leg / std::max(length, 1e-6f);
        path.direction = to_local * direction;
        path.valid =
            path.valid && length > 2.0f * leg_margin && emits_towards(light.emitter, emitted.normal, direction) &&
            !rays.occluded(raytrace::Ray{origin, direction, 0.0f, length - leg_margin}, raytrace::Scope::static_only);
    }
}

void DynamicLights::sample_path(Light& light, std::uint32_t index, const raytrace::RayScene& rays) {
    Path& path = light.paths[index];
    LightSample& sample = samples_[light.first + light.direct + index];
    const std::uint32_t seed = hash_combine(settings_.seed, 0x9a7u);
    RandomSequence random(SequenceKind::pseudo_random, seed, paths_made_++);
    const EmittedRay emitted = sample_emitter_ray(light.emitter, path.numbers);
    raytrace::Ray ray{emitted.origin + leg_margin * emitted.normal, emitted.direction, 0.0f, 1e30f};
    path.throughput = vec3(1.0f);
    path.escaped = false;
    path.valid = true;
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
        path.throughput *= point.material.base_colour;
        sample.position = lift_sample(point.position, normal, rays, raytrace::Scope::static_only);
        sample.normal = shading;
        sample.bounce = bounce;
        // What a path stops with is nearly the same wherever it stops, within limits: no sample outshines the others.
        const float largest =
            std::max({point.material.base_colour.x, point.material.base_colour.y, point.material.base_colour.z});
        const float stop = bounce == settings_.bounces ? 1.0f : std::clamp(1.0f - largest, 0.35f, 0.8f);
        const float u = random.next(), v = random.next();
        if (random.next() < stop) {
            path.throughput /= stop;
            break;
        }
        path.throughput /= 1.0f - stop;
        ray = {point.position + 1e-4f * normal, sample_cosine_direction(shading, u, v), 0.0f, 1e30f};
    }
    if (path.escaped) {
        path.first_hit = ray.origin + far_away * ray.direction;
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

// Invalid paths go to the middle of the largest gaps. When all are valid, but a gap is much larger than the rest, the
// path with the smallest cell goes there.
void DynamicLights::fill_gaps(Light& light, std::uint32_t most, const raytrace::RayScene& rays) {
    if (light.paths.empty())
        return;
    const std::size_t n = light.paths.size();
    std::vector<float> nearest(light.directions.size(), -2.0f); // largest cosine to any valid path
    std::vector<std::uint32_t> owner(light.directions.size(), 0);
    const auto claim = [&](std::uint32_t p) {
        for (std::size_t d = 0; d < light.directions.size(); ++d)
            if (const float cosine = glm::dot(light.paths[p].direction, light.directions[d]); cosine > nearest[d]) {
                nearest[d] = cosine;
                owner[d] = p;
            }
    };
    std::vector<std::uint32_t> wanted;
    for (std::uint32_t p = 0; p < n; ++p) {
        if (light.paths[p].valid)
            claim(p);
        else
            wanted.push_back(p);
    }
    if (wanted.empty()) {
        std::vector<float> cells(n, 0.0f);
        for (std::size_t d = 0; d < owner.size(); ++d)
            cells[owner[d]] += light.weights[d];
        const auto [least, largest] = std::minmax_element(cells.begin(), cells.end());
        if (*largest * float(n) < worst_cell * float(light.directions.size()))
            return;
        wanted.push_back(std::uint32_t(least - cells.begin()));
    }
    wanted.resize(std::min<std::size_t>(wanted.size(), most));
    for (const std::uint32_t p : wanted) {
        std::size_t gap = 0;
        for (std::size_t d = 1; d < nearest.size(); ++d)
            if (nearest[d] < nearest[gap])
                gap = d;
        std::copy(light.numbers[gap].begin(), light.numbers[gap].end(), light.paths[p].numbers);
        light.paths[p].direction = light.directions[gap];
        sample_path(light, p, rays);
        claim(p);
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

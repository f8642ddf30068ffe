#include "gi_module/light_sampling/followed_paths.h"

#include "engine/core/jobs.h"
#include "gi_module/light_sampling/light_sampler.h"
#include "gi_module/transport/reflectance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace sunfleck::gi {
namespace {

constexpr std::uint32_t direction_count = 512;
constexpr float segment_margin = 2e-3f; // units of the scene, off the source and the first surface
constexpr float out_of_scene = 1e4f;    // units of the scene
constexpr float landing_length = 1.0f;  // units of the scene, as far apart as surfaces that face elsewhere by a radian
constexpr std::uint32_t first_landing_seed = 0x80000000u; // of random numbers; those of samples' paths count from 0
constexpr float most_scaled = 4.0f;                       // to what walks leave in the mean
constexpr float max_cell = 3.0f; // times the mean: a path with a small cell moves into a larger one

mat3 rotation_of(const mat4& matrix) {
    mat3 result(matrix);
    for (int i = 0; i < 3; ++i)
        result[i] /= std::max(glm::length(result[i]), 1e-30f);
    return result;
}

// What a path makes of its light, and where it goes.
struct Walk {
    vec3 throughput{1.0f}, first_hit{0.0f}, first_normal{0.0f};
    std::uint32_t reflections = 0;
    bool escaped = false;
};

// A random walk from the emitted ray; the sample lies where it ends.
Walk trace(raytrace::Ray ray, const PathSpace& space, std::uint32_t path_seed, LightSample& sample) {
    Walk walk;
    sample.path_vertex_count = 0;
    const std::uint32_t seed = hash_combine(space.settings.seed, 0x9a7u);
    RandomSequence random(SequenceKind::pseudo_random, seed, path_seed);
    for (std::uint32_t bounce = 1; bounce <= space.bounces; ++bounce) {
        const auto hit = space.rays.closest_hit(ray, raytrace::Scope::static_only);
        add_path_vertex(sample, ray.origin);
        if (!hit) {
            walk.escaped = bounce == 1;
            walk.throughput = vec3(0.0f);
            break;
        }
        const raytrace::SurfacePoint point = space.rays.surface(ray, *hit);
        const float side = glm::dot(point.geometric_normal, ray.direction) < 0.0f ? 1.0f : -1.0f;
        const vec3 normal = side * point.geometric_normal, shading = side * point.shading_normal;
        if (bounce == 1) {
            walk.first_hit = point.position;
            walk.first_normal = normal;
        }
        const vec3 albedo = mean_reflectance(point.material);
        walk.throughput *= albedo;
        walk.reflections = bounce;
        sample.position = offset_from_surface(point.position, normal, space.rays, raytrace::Scope::static_only);
        sample.normal = shading;
        sample.bounce = space.first_bounce + bounce - 1;
        // The throughput of a path is nearly the same wherever it ends, within limits: no sample outshines the others.
        const float largest = std::max({albedo.x, albedo.y, albedo.z});
        const float stop = bounce == space.bounces ? 1.0f : std::clamp(1.0f - largest, 0.35f, 0.8f);
        const float u = random.next(), v = random.next();
        if (random.next() < stop) {
            walk.throughput /= stop;
            break;
        }
        walk.throughput /= 1.0f - stop;
        ray = {point.position + 1e-4f * normal, sample_cosine_direction(shading, u, v), 0.0f, 1e30f};
    }
    if (walk.escaped)
        walk.first_hit = ray.origin + out_of_scene * ray.direction;
    return walk;
}

} // namespace

void FollowedPaths::reset(const PathSource& source, std::uint32_t count, std::uint32_t seed) {
    paths_.assign(count, {});
    filled_ = false;
    landings_.clear();
    directions_.clear();
    weights_.clear();
    numbers_.clear();
    const mat3 to_local = glm::transpose(rotation_of(source.matrix()));
    directions_.reserve(direction_count);
    weights_.reserve(direction_count);
    numbers_.reserve(direction_count);
    for (std::uint32_t i = 0; i < direction_count; ++i) {
        const RandomSequence random(SequenceKind::sobol, seed, i);
        const std::array<float, 4> numbers = {random.at(0), random.at(1), random.at(2), random.at(3)};
        directions_.push_back(to_local * source.ray(numbers.data()).direction);
        weights_.push_back(source.weight(numbers.data()));
        numbers_.push_back(numbers);
    }
}

bool FollowedPaths::complete() const {
    return std::all_of(paths_.begin(), paths_.end(), [](const Path& path) { return path.valid; });
}

std::uint32_t FollowedPaths::unsettled() const {
    return std::uint32_t(std::count_if(paths_.begin(), paths_.end(), [](const Path& path) { return !path.settled; }));
}

void FollowedPaths::land(const PathSource& source, const PathSpace& space) {
    if (!source.is_extended())
        return;
    landings_.assign(numbers_.size(), {});
    parallel_for_chunks(numbers_.size(), 64, [&](std::size_t begin, std::size_t end) {
        LightSample sample;
        sample.emitter = source.entity();
        sample.dynamic = true;
        for (std::size_t d = begin; d < end; ++d) {
            const EmittedRay emitted = source.ray(numbers_[d].data());
            const raytrace::Ray ray{emitted.origin + segment_margin * emitted.normal, emitted.direction, 0.0f, 1e30f};
            const Walk walk = trace(ray, space, first_landing_seed + std::uint32_t(d), sample);
            const bool blocked = space.blocked && space.blocked(sample);
            landings_[d] = {{vec3(0.0f), walk.first_hit, walk.first_normal, walk.escaped},
                            blocked ? vec3(0.0f) : walk.throughput,
                            walk.reflections};
        }
    });
}

void FollowedPaths::validate(const PathSource& source, const raytrace::RayScene& rays) {
    const mat3 to_local = glm::transpose(rotation_of(source.matrix()));
    for (Path& path : paths_) {
        path.settled = false;
        const EmittedRay emitted = source.ray(numbers_[path.number].data());
        const vec3 origin = emitted.origin + segment_margin * emitted.normal;
        const vec3 segment = path.first.end - origin;
        const float length = glm::length(segment);
        const vec3 direction = segment / std::max(length, 1e-6f);
        path.first.direction = to_local * direction;
        path.valid = path.valid && length > 2.0f * segment_margin && source.emits_towards(emitted.normal, direction) &&
                     !rays.occluded(raytrace::Ray{origin, direction, 0.0f, length - segment_margin},
                                    raytrace::Scope::static_only);
    }
}

void FollowedPaths::sample_path(const PathSource& source, std::uint32_t index, const PathSpace& space,
                                std::uint32_t seed, LightSample& sample) {
    Path& path = paths_[index];
    path.first.direction = directions_[path.number];
    const EmittedRay emitted = source.ray(numbers_[path.number].data());
    const raytrace::Ray ray{emitted.origin + segment_margin * emitted.normal, emitted.direction, 0.0f, 1e30f};
    const Walk walk = trace(ray, space, seed, sample);
    path.throughput = walk.throughput;
    path.reflections = walk.reflections;
    path.first.end = walk.first_hit;
    path.first.normal = walk.first_normal;
    path.first.escaped = walk.escaped;
    path.valid = true;
    if (walk.escaped) {
        sample.position = emitted.origin;
        sample.normal = emitted.direction;
        sample.bounce = space.first_bounce;
    }
    sample.kind = SampleKind::surface;
    sample.emitter = source.entity();
    sample.dynamic = true;
    if (!space.moved.empty())
        space.moved[index] = 1;
}

// The rays of the source's light, by the valid path that each is nearest to.
struct FollowedPaths::Cells {
    static constexpr float nowhere = std::numeric_limits<float>::lowest();

    explicit Cells(const FollowedPaths& followed)
        : all(followed), nearest(followed.directions_.size(), nowhere), owner(followed.directions_.size(), 0) {}

    const FollowedPaths& all;
    std::vector<float> nearest; // greatest likeness to any path
    std::vector<std::uint32_t> owner;

    bool lands(std::size_t ray) const { return all.landings_.empty() || !all.landings_[ray].first.escaped; }
    // The cosine between directions, or the less the further apart light lands, on surfaces that face elsewhere.
    float likeness(const Segment& segment, std::size_t ray) const {
        if (all.landings_.empty())
            return glm::dot(segment.direction, all.directions_[ray]);
        const Segment& landing = all.landings_[ray].first;
        const vec3 apart = segment.end - landing.end, turned = segment.normal - landing.normal;
        return -glm::dot(apart, apart) / (landing_length * landing_length) - glm::dot(turned, turned);
    }
    void add(std::uint32_t path, const Segment& segment) {
        if (segment.escaped && !all.landings_.empty())
            return;
        for (std::size_t d = 0; d < nearest.size(); ++d)
            if (const float like = lands(d) ? likeness(segment, d) : nowhere; like > nearest[d]) {
                nearest[d] = like;
                owner[d] = path;
            }
    }
    void add_valid() {
        for (std::uint32_t p = 0; p < all.paths_.size(); ++p)
            if (all.paths_[p].valid)
                add(p, all.paths_[p].first);
    }

    // The path with the smallest cell, if the largest is much larger than the mean.
    std::optional<std::uint32_t> most_crowded() const {
        std::vector<float> cells(all.paths_.size(), 0.0f);
        float total = 0.0f;
        for (std::size_t d = 0; d < owner.size(); ++d) {
            if (nearest[d] == nowhere)
                continue;
            const vec3 weight = all.weights_[d];
            cells[owner[d]] += weight.x + weight.y + weight.z;
            total += weight.x + weight.y + weight.z;
        }
        const auto [smallest, largest] = std::minmax_element(cells.begin(), cells.end());
        if (!(total > 0.0f) || *largest * float(cells.size()) < max_cell * total)
            return std::nullopt;
        return std::uint32_t(smallest - cells.begin());
    }

    std::uint32_t largest_gap() const {
        std::size_t least = 0;
        for (std::size_t d = 1; d < nearest.size(); ++d)
            if (lands(d) && (!lands(least) || nearest[d] < nearest[least]))
                least = d;
        return std::uint32_t(least);
    }
};

std::uint32_t FollowedPaths::fill_gaps(const PathSource& source, std::uint32_t most, const PathSpace& space,
                                       std::span<LightSample> samples) {
    if (paths_.empty())
        return 0;
    Cells cells(*this);
    cells.add_valid();
    std::vector<std::uint32_t> chosen;
    for (std::uint32_t p = 0; p < paths_.size(); ++p)
        if (!paths_[p].valid)
            chosen.push_back(p);
    if (chosen.empty()) {
        const std::optional<std::uint32_t> moved = cells.most_crowded();
        if (!moved)
            return 0;
        chosen.push_back(*moved);
    }
    chosen.resize(std::min<std::size_t>(chosen.size(), most));
    for (const std::uint32_t p : chosen) {
        Path& path = paths_[p];
        path.number = cells.largest_gap();
        const std::uint32_t seed = space.paths_made++;
        sample_path(source, p, space, seed, samples[p]);
        path.settled = !filled_;
        if (!filled_)
            path.first_seed = seed;
        cells.add(p, path.first);
    }
    filled_ = true;
    return std::uint32_t(chosen.size());
}

void FollowedPaths::settle(const PathSource& source, std::uint32_t most, const PathSpace& space,
                           std::span<LightSample> samples) {
    Cells cells(*this);
    for (std::uint32_t p = 0; p < paths_.size() && most > 0; ++p) {
        Path& path = paths_[p];
        const std::uint32_t number = cells.largest_gap();
        cells.add(p, landings_[number].first);
        if (path.settled)
            continue;
        path.number = number;
        sample_path(source, p, space, path.first_seed, samples[p]);
        path.settled = true;
        --most;
    }
}

// W, of all samples together: what the walks of all landings leave in the mean. `total`: of the weights.
vec3 FollowedPaths::arriving(const PathSource& source, vec3 total) const {
    vec3 sum(0.0f);
    for (std::size_t d = 0; d < landings_.size(); ++d)
        sum += weights_[d] * landings_[d].throughput * source.flux(landings_[d].reflections);
    return sum / glm::max(total, vec3(1e-30f));
}

void FollowedPaths::share_flux(const PathSource& source, std::span<LightSample> samples,
                               const std::function<bool(const LightSample&)>& blocked) {
    if (source.weights_vary())
        for (std::size_t d = 0; d < numbers_.size(); ++d)
            weights_[d] = source.weight(numbers_[d].data());
    Cells cells(*this);
    cells.add_valid();
    std::vector<vec3> shares(paths_.size(), vec3(0.0f));
    vec3 total(0.0f);
    for (std::size_t d = 0; d < directions_.size(); ++d) {
        total += weights_[d];
        if (cells.nearest[d] > Cells::nowhere)
            shares[cells.owner[d]] += weights_[d];
    }
    vec3 found(0.0f);
    for (std::size_t p = 0; p < paths_.size(); ++p) {
        if (samples[p].path_vertex_count == paths_[p].reflections && samples[p].path_vertex_count > 0) // all of it
            samples[p].path[0] = source.ray(numbers_[paths_[p].number].data()).origin;
        const vec3 flux = source.flux(paths_[p].reflections) * paths_[p].throughput;
        for (int c = 0; c < 3; ++c)
            paths_[p].share[c] = total[c] > 0.0f ? shares[p][c] / total[c] : 0.0f;
        samples[p].flux = flux * paths_[p].share;
        if (!blocked || !blocked(samples[p]))
            found += samples[p].flux;
    }
    if (landings_.empty())
        return;
    // A few walks end after more or fewer reflections than the mean, which shows in the picture as a whole.
    const vec3 wanted = arriving(source, total);
    vec3 scale(1.0f);
    for (int c = 0; c < 3; ++c)
        if (found[c] > 0.0f)
            scale[c] = std::clamp(wanted[c] / found[c], 1.0f / most_scaled, most_scaled);
    for (std::size_t p = 0; p < paths_.size(); ++p) {
        paths_[p].share *= scale;
        samples[p].flux *= scale;
    }
}

} // namespace sunfleck::gi

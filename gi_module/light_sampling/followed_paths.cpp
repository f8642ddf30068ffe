#include "gi_module/light_sampling/followed_paths.h"

#include "gi_module/light_sampling/light_sampler.h"
#include "gi_module/transport/reflectance.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace sunfleck::gi {
namespace {

constexpr std::uint32_t direction_count = 512;
constexpr float segment_margin = 2e-3f; // units of the scene, off the source and the first surface
constexpr float out_of_scene = 1e4f;    // units of the scene
constexpr float max_cell = 3.0f;        // times the mean: a path with a small cell moves into a larger one

mat3 rotation_of(const mat4& matrix) {
    mat3 result(matrix);
    for (int i = 0; i < 3; ++i)
        result[i] /= std::max(glm::length(result[i]), 1e-30f);
    return result;
}

// What a path makes of its light, and where it goes.
struct Walk {
    vec3 throughput{1.0f}, first_hit{0.0f};
    std::uint32_t reflections = 0;
    bool escaped = false;
};

// A random walk from the emitted ray; the sample lies where it ends.
Walk trace(raytrace::Ray ray, const PathSpace& space, LightSample& sample) {
    Walk walk;
    const std::uint32_t seed = hash_combine(space.settings.seed, 0x9a7u);
    RandomSequence random(SequenceKind::pseudo_random, seed, space.paths_made++);
    for (std::uint32_t bounce = 1; bounce <= space.bounces; ++bounce) {
        const auto hit = space.rays.closest_hit(ray, raytrace::Scope::static_only);
        if (!hit) {
            walk.escaped = bounce == 1;
            walk.throughput = vec3(0.0f);
            break;
        }
        const raytrace::SurfacePoint point = space.rays.surface(ray, *hit);
        const float side = glm::dot(point.geometric_normal, ray.direction) < 0.0f ? 1.0f : -1.0f;
        const vec3 normal = side * point.geometric_normal, shading = side * point.shading_normal;
        if (bounce == 1)
            walk.first_hit = point.position;
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
    directions_.clear();
    weights_.clear();
    numbers_.clear();
    const mat3 to_local = glm::transpose(rotation_of(source.matrix()));
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

void FollowedPaths::validate(const PathSource& source, const raytrace::RayScene& rays) {
    const mat3 to_local = glm::transpose(rotation_of(source.matrix()));
    for (Path& path : paths_) {
        const EmittedRay emitted = source.ray(path.numbers);
        const vec3 origin = emitted.origin + segment_margin * emitted.normal;
        const vec3 segment = path.first_hit - origin;
        const float length = glm::length(segment);
        const vec3 direction = segment / std::max(length, 1e-6f);
        path.direction = to_local * direction;
        path.valid = path.valid && length > 2.0f * segment_margin && source.emits_towards(emitted.normal, direction) &&
                     !rays.occluded(raytrace::Ray{origin, direction, 0.0f, length - segment_margin},
                                    raytrace::Scope::static_only);
    }
}

void FollowedPaths::sample_path(const PathSource& source, std::uint32_t index, const PathSpace& space,
                                LightSample& sample) {
    Path& path = paths_[index];
    const EmittedRay emitted = source.ray(path.numbers);
    const Walk walk =
        trace({emitted.origin + segment_margin * emitted.normal, emitted.direction, 0.0f, 1e30f}, space, sample);
    path.throughput = walk.throughput;
    path.reflections = walk.reflections;
    path.first_hit = walk.first_hit;
    path.escaped = walk.escaped;
    path.valid = true;
    if (path.escaped) {
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

// The directions of the source's light, by the valid path that each is nearest to.
struct FollowedPaths::Cells {
    explicit Cells(const FollowedPaths& followed)
        : all(followed), nearest(followed.directions_.size(), -2.0f), owner(followed.directions_.size(), 0) {}

    const FollowedPaths& all;
    std::vector<float> nearest; // largest cosine to any path
    std::vector<std::uint32_t> owner;

    void add(std::uint32_t path) {
        for (std::size_t d = 0; d < nearest.size(); ++d)
            if (const float cosine = glm::dot(all.paths_[path].direction, all.directions_[d]); cosine > nearest[d]) {
                nearest[d] = cosine;
                owner[d] = path;
            }
    }
    void add_valid() {
        for (std::uint32_t p = 0; p < all.paths_.size(); ++p)
            if (all.paths_[p].valid)
                add(p);
    }

    // The path with the smallest cell, if the largest is much larger than the mean.
    std::optional<std::uint32_t> most_crowded() const {
        std::vector<float> cells(all.paths_.size(), 0.0f);
        float total = 0.0f;
        for (std::size_t d = 0; d < owner.size(); ++d) {
            const vec3 weight = all.weights_[d];
            cells[owner[d]] += weight.x + weight.y + weight.z;
            total += weight.x + weight.y + weight.z;
        }
        const auto [smallest, largest] = std::minmax_element(cells.begin(), cells.end());
        if (!(total > 0.0f) || *largest * float(cells.size()) < max_cell * total)
            return std::nullopt;
        return std::uint32_t(smallest - cells.begin());
    }

    std::size_t largest_gap() const {
        return std::size_t(std::min_element(nearest.begin(), nearest.end()) - nearest.begin());
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
        const std::size_t gap = cells.largest_gap();
        std::copy(numbers_[gap].begin(), numbers_[gap].end(), paths_[p].numbers);
        paths_[p].direction = directions_[gap];
        sample_path(source, p, space, samples[p]);
        cells.add(p);
    }
    return std::uint32_t(chosen.size());
}

void FollowedPaths::share_flux(const PathSource& source, std::span<LightSample> samples) {
    if (source.weights_vary())
        for (std::size_t d = 0; d < numbers_.size(); ++d)
            weights_[d] = source.weight(numbers_[d].data());
    Cells cells(*this);
    cells.add_valid();
    std::vector<vec3> shares(paths_.size(), vec3(0.0f));
    vec3 total(0.0f);
    for (std::size_t d = 0; d < directions_.size(); ++d) {
        total += weights_[d];
        if (cells.nearest[d] > -2.0f)
            shares[cells.owner[d]] += weights_[d];
    }
    for (std::size_t p = 0; p < paths_.size(); ++p) {
        const vec3 flux = source.flux(paths_[p].reflections) * paths_[p].throughput;
        for (int c = 0; c < 3; ++c)
            samples[p].flux[c] = total[c] > 0.0f ? flux[c] * (shares[p][c] / total[c]) : 0.0f;
    }
}

} // namespace sunfleck::gi

#include "gi_module/light_sampling/clamping_loss.h"

#include "gi_module/light_sampling/emitters.h"

#include "engine/core/jobs.h"
#include "engine/core/random.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace sunfleck::gi {
namespace {

// Rays for all samples together.
constexpr std::size_t ray_budget = 1u << 13;
constexpr std::size_t min_rays = 4, max_rays = 128;

} // namespace

float clamping_loss_of(const LightSample& sample, float bound, std::size_t ray_count, const raytrace::RayScene& rays) {
    const RandomSequence random(SequenceKind::sobol, 0xc1a3, sample.index);
    double sum = 0.0;
    for (std::size_t k = 0; k < ray_count; ++k) {
        const RandomSequence numbers(SequenceKind::sobol, 0xc1a3, std::uint32_t(k));
        // One pattern, shifted by the sample, so that neighbours do not err alike.
        const float u = std::fmod(numbers.at(0) + random.at(2), 1.0f),
                    v = std::fmod(numbers.at(1) + random.at(3), 1.0f);
        const vec3 direction = sample_cosine_direction(sample.normal, u, v);
        const raytrace::Ray ray{sample.position, direction, 0.0f, 1e30f};
        const auto hit = rays.closest_hit(ray, raytrace::Scope::static_only);
        if (!hit)
            continue;
        const float receiver = std::abs(glm::dot(rays.surface(ray, *hit).geometric_normal, direction));
        const float term = glm::dot(sample.normal, direction) * receiver / (hit->distance * hit->distance);
        sum += term > bound ? 1.0 - double(bound / term) : 0.0;
    }
    return float(sum / double(ray_count));
}

double clamping_loss(std::span<const LightSample> samples, std::span<const float> bounds,
                     const raytrace::RayScene& rays) {
    const std::size_t ray_count = std::clamp(ray_budget / std::max<std::size_t>(samples.size(), 1), min_rays, max_rays);
    std::vector<double> light(samples.size(), 0.0), lost(samples.size(), 0.0);
    parallel_for_chunks(samples.size(), 16, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            if (samples[i].kind != SampleKind::surface || samples[i].dynamic)
                continue;
            light[i] = double(luminance(samples[i].flux));
            lost[i] = light[i] * double(clamping_loss_of(samples[i], bounds[i], ray_count, rays));
        }
    });
    const double all = std::accumulate(light.begin(), light.end(), 0.0);
    return all > 0.0 ? std::accumulate(lost.begin(), lost.end(), 0.0) / all : 0.0;
}

} // namespace sunfleck::gi

#include "gi_module/light_sampling/light_sampler.h"

#include "gi_module/light_sampling/sample_clusters.h"
#include "gi_module/transport/reflectance.h"

#include "engine/core/jobs.h"
#include "engine/core/progress_part.h"
#include "engine/core/random.h"

#include <algorithm>

namespace sunfleck::gi {
namespace {

constexpr float ray_offset = 1e-4f; // units of the scene, off the surface that a walk leaves
constexpr std::uint32_t walks_per_round = 256;
constexpr std::uint64_t max_candidates = 1u << 18;

// How many walks are begun for so many samples. Where fewer than one in 16 of them reaches anything, as with a lamp in
// the open, more walks would only find again what these found: the samples are fewer then, and no less right. The
// least number costs less than a frame, and lets a small count find what one walk in a thousand hits.
std::uint32_t most_walks(std::uint64_t wanted) {
    return std::uint32_t(std::clamp<std::uint64_t>(16 * wanted, 1u << 16, 1u << 22));
}

// Random walks from emitters, which are chosen by flux.
class RandomWalks {
public:
    RandomWalks(const std::vector<Emitter>& emitters, const SampleRequest& settings, const raytrace::RayScene& rays)
        : emitters_(emitters), settings_(settings), rays_(rays), scope_(walk_scope(settings)) {
        double total = 0;
        for (const Emitter& emitter : emitters)
            cumulative_.push_back(total += double(luminance(emitter.flux)));
    }

    // The samples of walk `index`, for a flux of 1 W in all walks together (divided by their number later).
    std::vector<LightSample> walk(std::uint32_t index) const {
        std::vector<LightSample> samples;
        RandomSequence random(sequence_kind(settings_), hash_combine(settings_.seed, 0x1d1), index);
        const float numbers[4] = {random.at(0), random.at(1), random.at(2), random.at(3)};
        const Emitter& emitter = emitters_[choose_emitter(cumulative_, double(random.at(4)) * cumulative_.back())];
        const EmittedRay emitted = sample_emitter_ray(emitter, numbers);
        vec3 flux =
            emitter.flux * emitted.tint * emitted.weight * float(cumulative_.back() / double(luminance(emitter.flux)));
        raytrace::Ray ray{emitted.origin + ray_offset * emitted.normal, emitted.direction, 0.0f, 1e30f};
        for (std::uint32_t bounce = 1; bounce <= settings_.bounces; ++bounce) {
            const auto hit = rays_.closest_hit(ray, scope_);
            if (!hit)
                break;
            const raytrace::SurfacePoint point = rays_.surface(ray, *hit);
            const bool front = glm::dot(point.geometric_normal, ray.direction) < 0.0f;
            const vec3 normal = front ? point.geometric_normal : -point.geometric_normal;
            const vec3 shading_normal = front ? point.shading_normal : -point.shading_normal;
            random.seek(8 + bounce * 4);
            const float u = random.next(), v = random.next(), survive = random.next();
            if (!reflect(flux, mean_reflectance(point.material), survive))
                break;
            LightSample sample;
            sample.position = offset_from_surface(point.position, normal, rays_, scope_);
            sample.normal = shading_normal;
            sample.flux = flux;
            sample.bounce = bounce;
            sample.emitter = emitter.entity;
            extend_path(sample, samples, ray.origin);
            samples.push_back(sample);
            ray = {point.position + ray_offset * normal, sample_cosine_direction(shading_normal, u, v), 0.0f, 1e30f};
            if (glm::dot(ray.direction, normal) <= 0.0f)
                break; // below the geometric surface
        }
        return samples;
    }

private:
    // False if the walk ends. Russian roulette comes before the sample is placed, so that samples carry nearly equal
    // flux.
    bool reflect(vec3& flux, vec3 albedo, float survive) const {
        flux *= albedo;
        if (settings_.termination == Termination::russian_roulette) {
            const float probability = std::clamp(std::max({albedo.x, albedo.y, albedo.z}), 0.05f, 1.0f);
            if (survive >= probability)
                return false;
            flux /= probability;
        }
        return luminance(flux) > 0.0f;
    }

    static void extend_path(LightSample& sample, const std::vector<LightSample>& before, vec3 vertex) {
        if (!before.empty()) {
            sample.path = before.back().path;
            sample.path_vertex_count = before.back().path_vertex_count;
        }
        add_path_vertex(sample, vertex);
    }

    const std::vector<Emitter>& emitters_;
    const SampleRequest& settings_;
    const raytrace::RayScene& rays_;
    raytrace::Scope scope_;
    std::vector<double> cumulative_; // flux of the emitters, summed up
};

// Keeps `count` of the samples, evenly spread over them, and scales their flux up to that of all.
std::vector<LightSample> thin_out(std::vector<LightSample> samples, std::uint32_t count, std::uint32_t seed) {
    if (samples.size() <= count)
        return samples;
    const double step = double(samples.size()) / count;
    const double start = double(to_unit_float(hash_combine(seed, 991))) * step;
    std::vector<LightSample> kept;
    for (std::uint32_t i = 0; i < count; ++i) {
        const std::size_t place = std::min(samples.size() - 1, std::size_t(start + i * step));
        kept.push_back(samples[place]);
        kept.back().flux *= float(step);
    }
    return kept;
}

} // namespace

std::vector<LightSample> sample_indirect(const std::vector<Emitter>& emitters, std::uint32_t count,
                                         const SampleRequest& settings, const raytrace::RayScene& rays,
                                         const std::function<bool(float)>& progress) {
    if (count == 0 || emitters.empty() || settings.bounces == 0)
        return {};
    const RandomWalks random_walks(emitters, settings, rays);
    std::vector<LightSample> samples;
    std::uint32_t walks = 0;
    // For clustering, several times as many samples are drawn, and similar ones are then merged.
    const std::uint64_t wanted = std::max<std::uint64_t>(
        count, std::min<std::uint64_t>(std::uint64_t(count) * settings.candidates, max_candidates));
    const std::uint32_t max_walks = most_walks(wanted);
    const std::function<bool(float)> walking = progress_part(progress, 0.0f, settings.candidates > 1 ? 0.5f : 1.0f);
    const auto share_walked = [&] {
        return std::max(float(samples.size()) / float(wanted), float(walks) / float(max_walks));
    };
    while (samples.size() < wanted && walks < max_walks) {
        if (walking && !walking(share_walked()))
            return {};
        // Rounds run in parallel; walks are then taken in order until there are enough samples.
        std::vector<std::vector<LightSample>> round(walks_per_round);
        parallel_for_chunks(walks_per_round, 16, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                round[i] = random_walks.walk(walks + std::uint32_t(i));
        });
        for (std::size_t i = 0; i < round.size() && samples.size() < wanted; ++i, ++walks)
            samples.insert(samples.end(), round[i].begin(), round[i].end());
    }
    if (walks > 0)
        for (LightSample& sample : samples)
            sample.flux /= float(walks);
    if (settings.candidates > 1)
        return cluster_samples(samples, count, settings.spread, settings.seed, progress_part(progress, 0.5f, 1.0f));
    return thin_out(std::move(samples), count, settings.seed);
}

} // namespace sunfleck::gi

#include "gi_module/light_sampling/light_sampler.h"

#include "engine/core/random.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace sunfleck::gi {
namespace {

constexpr float surface_offset = 1e-3f; // units of the scene (engine/scene/scene_space.h)

LightSample delta_sample(const Emitter& emitter) {
    LightSample sample;
    const EmittedPoint point = sample_emitter_point(emitter, 0.5f, 0.5f);
    sample.emitter = emitter.entity;
    sample.position = point.position;
    sample.normal = point.normal;
    sample.flux = emitter.flux;
    sample.punctual = emitter.punctual;
    if (emitter.kind == EmitterKind::point) {
        sample.kind = SampleKind::point;
    } else if (emitter.kind == EmitterKind::spot) {
        sample.kind = SampleKind::spot;
        sample.flux = emitter.intensity;
        spot_cone(emitter, sample.cone_scale, sample.cone_offset);
    } else {
        sample.kind = SampleKind::directional;
        sample.flux = emitter.intensity;
    }
    return sample;
}

// Fewer samples lie on one side of a closed emitter's middle, or in a plane with it.
constexpr std::uint32_t least_around = 4;

// One of `count` samples that share the flux of an emitter.
LightSample shared_sample(const Emitter& emitter, float count, const RandomSequence& random,
                          const raytrace::RayScene& rays) {
    LightSample sample;
    sample.emitter = emitter.entity;
    if (emitter.kind == EmitterKind::environment) {
        sample.kind = SampleKind::directional;
        if (emitter.map.image) {
            const scene::EnvironmentImage::Draw drawn = emitter.map.image->draw(random.at(0), random.at(1));
            sample.normal = -emitter.map.to_world(drawn.direction);
            sample.flux =
                drawn.density > 0.0f ? emitter.map_scale * drawn.radiance / (drawn.density * count) : vec3(0.0f);
        } else {
            sample.normal = sample_sphere_direction(random.at(0), random.at(1));
            sample.flux = emitter.radiance * (4.0f * pi / count);
        }
        sample.position = emitter.scene_centre - emitter.scene_radius * sample.normal;
        return sample;
    }
    const EmittedPoint point = sample_emitter_point(emitter, random.at(0), random.at(1));
    sample.position = offset_from_surface(point.position, point.normal, rays, raytrace::Scope::everything);
    sample.normal = point.normal;
    sample.flux = emitter.flux / count;
    if (!emitter.closed || count >= float(least_around))
        sample.radius = std::sqrt(emitter.area / (pi * count));
    return sample;
}

// A sample on the surface of a ball lights one side alone, and not what the ball touches: few samples miss what is next
// to it. Points within it that shine in all directions light as the ball does wherever all of it is above the horizon,
// as a shell's gravity is that of its centre; spread as the first three coordinates of points on a sphere in four
// dimensions, they look like a disc of even brightness from everywhere, so that penumbrae are right, too. Few points
// stay near the centre: none gives what the ball touches more light than the whole ball does.
LightSample ball_sample(const Emitter& emitter, float count, const RandomSequence& random) {
    LightSample sample;
    sample.kind = SampleKind::point;
    sample.emitter = emitter.entity;
    sample.on_mover = true;
    const float inner = std::sqrt(random.at(0)), outer = std::sqrt(1.0f - random.at(0));
    const float first = 2.0f * pi * random.at(1), second = 2.0f * pi * random.at(2);
    const vec3 place(outer * std::cos(first), outer * std::sin(first), inner * std::cos(second));
    sample.position = vec3(emitter.matrix[3]) + emitter.radius * (1.0f - 1.0f / std::sqrt(count)) * place;
    sample.flux = emitter.flux / count;
    sample.radius = emitter.radius / std::sqrt(count);
    return sample;
}

// Fewer samples than emitters: systematic sampling of emitters by flux.
std::vector<LightSample> sample_some_emitters(const std::vector<Emitter>& emitters, std::uint32_t count,
                                              const SampleRequest& settings, const raytrace::RayScene& rays) {
    std::vector<double> cumulative;
    cumulative.reserve(emitters.size());
    double total = 0;
    for (const Emitter& emitter : emitters)
        cumulative.push_back(total += double(luminance(emitter.flux)));
    const double start = double(to_unit_float(hash_combine(settings.seed, 77)));
    std::vector<LightSample> samples;
    for (std::uint32_t i = 0; i < count; ++i) {
        const double target = (double(i) + start) / count * total;
        const Emitter& emitter = emitters[choose_emitter(cumulative, target)];
        const float expected = float(double(luminance(emitter.flux)) / total * count);
        LightSample sample = emitter.is_delta()
                                 ? delta_sample(emitter)
                                 : shared_sample(emitter, 1.0f, {sequence_kind(settings), settings.seed, i}, rays);
        sample.flux /= expected;
        samples.push_back(sample);
    }
    return samples;
}

} // namespace

SequenceKind sequence_kind(const SampleRequest& settings) {
    return settings.sequence == Sequence::sobol ? SequenceKind::sobol : SequenceKind::pseudo_random;
}

raytrace::Scope walk_scope(const SampleRequest& settings) {
    return settings.movers_are_static ? raytrace::Scope::everything : raytrace::Scope::static_only;
}

std::size_t choose_emitter(const std::vector<double>& cumulative, double target) {
    return std::min<std::size_t>(
        std::size_t(std::upper_bound(cumulative.begin(), cumulative.end(), target) - cumulative.begin()),
        cumulative.size() - 1);
}

// The largest-remainder method; of equal remainders, the first wins.
void add_path_vertex(LightSample& sample, vec3 point) {
    if (sample.path_vertex_count == LightSample::max_path_vertices) {
        std::rotate(sample.path.begin(), sample.path.begin() + 1, sample.path.end());
        --sample.path_vertex_count;
    }
    sample.path[sample.path_vertex_count++] = point;
}

std::vector<std::uint32_t> apportion(const std::vector<double>& weights, std::uint32_t count) {
    const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
    std::vector<std::uint32_t> result(weights.size());
    std::vector<std::pair<double, std::size_t>> remainders;
    std::uint32_t given = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
        // At least one each, so that no light is lost.
        const double exact = std::max(1.0, weights[i] / total * count);
        result[i] = std::uint32_t(exact);
        remainders.emplace_back(exact - std::floor(exact), i);
        given += result[i];
    }
    std::stable_sort(remainders.begin(), remainders.end(), [](auto& a, auto& b) { return a.first > b.first; });
    for (std::size_t i = 0; given < count; i = (i + 1) % remainders.size(), ++given)
        ++result[remainders[i].second];
    while (given > count) {
        --*std::max_element(result.begin(), result.end());
        --given;
    }
    return result;
}

LightSample make_direct_sample(const Emitter& emitter, std::uint32_t index, std::uint32_t count,
                               const SampleRequest& settings, const raytrace::RayScene& rays) {
    if (emitter.is_delta())
        return delta_sample(emitter);
    const RandomSequence random(sequence_kind(settings), hash_combine(settings.seed, emitter.entity.index), index);
    if (emitter.ball && emitter.moves)
        return ball_sample(emitter, float(count), random);
    return shared_sample(emitter, float(count), random, rays);
}

std::uint32_t useful_samples(const Emitter& emitter, std::uint32_t share) {
    if (emitter.is_delta() || (emitter.ball && emitter.moves && share < least_around))
        return 1;
    return std::max(share, 1u);
}

vec3 offset_from_surface(vec3 position, vec3 normal, const raytrace::RayScene& rays, raytrace::Scope scope) {
    const raytrace::Ray ray{position + 1e-5f * normal, normal, 0.0f, 2.0f * surface_offset};
    const auto hit = rays.closest_hit(ray, scope);
    return position + normal * (hit ? 0.5f * hit->distance : surface_offset);
}

SampleBudget divide_samples(const SampleRequest& settings, const std::vector<Emitter>& emitters) {
    SampleBudget budget;
    if (emitters.empty() || settings.lights == 0)
        return budget;
    const bool direct = settings.direct;
    const bool indirect = settings.indirect && settings.bounces > 0;
    if (!direct && !indirect)
        return budget;
    std::uint32_t share = std::uint32_t(std::lround(double(settings.direct_share) * settings.lights));
    const std::size_t deltas =
        std::size_t(std::count_if(emitters.begin(), emitters.end(), [](const Emitter& e) { return e.is_delta(); }));
    if (deltas == emitters.size())
        share = std::min<std::uint32_t>(std::max<std::uint32_t>(share, std::uint32_t(deltas)), std::uint32_t(deltas));
    else
        share = std::max<std::uint32_t>(share, std::uint32_t(deltas) + 1); // every emitter gets one
    if (!indirect)
        share = deltas == emitters.size() ? std::uint32_t(deltas) : settings.lights;
    budget.direct = direct ? std::min(share, settings.lights) : 0;
    budget.indirect = indirect ? settings.lights - budget.direct : 0;
    if (settings.lights == 1 && direct && indirect)
        budget = {1, 0};
    return budget;
}

std::vector<LightSample> sample_direct(const std::vector<Emitter>& emitters, std::uint32_t count,
                                       const SampleRequest& settings, const raytrace::RayScene& rays) {
    if (count == 0 || emitters.empty())
        return {};
    if (count < emitters.size())
        return sample_some_emitters(emitters, count, settings, rays);
    std::vector<LightSample> samples;
    std::vector<double> weights;
    std::vector<const Emitter*> sharing;
    for (const Emitter& emitter : emitters) {
        if (emitter.is_delta()) {
            samples.push_back(delta_sample(emitter));
        } else {
            sharing.push_back(&emitter);
            weights.push_back(double(luminance(emitter.flux)));
        }
    }
    if (sharing.empty())
        return samples;
    const std::vector<std::uint32_t> counts = apportion(weights, count - std::uint32_t(samples.size()));
    for (std::size_t e = 0; e < sharing.size(); ++e) {
        const std::uint32_t seed = hash_combine(settings.seed, 0xd000 + std::uint32_t(e));
        for (std::uint32_t i = 0; i < counts[e]; ++i)
            samples.push_back(shared_sample(*sharing[e], float(counts[e]), {sequence_kind(settings), seed, i}, rays));
    }
    return samples;
}

} // namespace sunfleck::gi

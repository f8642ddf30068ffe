#include "gi_module/light_sampling/dynamic_lights.h"

#include "gi_module/light_sampling/light_sampler.h"

#include <algorithm>

namespace sunfleck::gi {
namespace {

constexpr std::uint32_t max_resampled = 4; // per light and frame

class EmitterSource final : public PathSource {
public:
    explicit EmitterSource(const Emitter& emitter) : emitter_(emitter) {}

    EmittedRay ray(const float numbers[4]) const override { return sample_emitter_ray(emitter_, numbers); }
    bool emits_towards(vec3 normal, vec3 direction) const override {
        if (emitter_.kind == EmitterKind::point)
            return true;
        if (emitter_.kind == EmitterKind::spot)
            return glm::dot(direction, sample_emitter_point(emitter_, 0.5f, 0.5f).normal) > emitter_.outer_cosine;
        return glm::dot(direction, normal) > 0.0f;
    }
    ecs::Entity entity() const override { return emitter_.entity; }
    const mat4& matrix() const override { return emitter_.matrix; }
    vec3 flux(std::uint32_t) const override { return emitter_.flux; }
    vec3 weight(const float numbers[4]) const override { return vec3(ray(numbers).weight); }
    bool weights_vary() const override { return false; }
    bool is_extended() const override { return false; }

private:
    const Emitter& emitter_;
};

} // namespace

void DynamicLights::reset(const std::vector<Emitter>& emitters, std::uint32_t count, const SampleRequest& settings,
                          const raytrace::RayScene& rays) {
    settings_ = settings;
    lights_.clear();
    samples_.clear();
    moved_.clear();
    resampled_ = paths_made_ = 0;
    changed_ = false;
    if (emitters.empty() || (!settings.direct && !(settings.indirect && settings.bounces > 0)))
        return;
    std::vector<double> weights;
    weights.reserve(emitters.size());
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
    if (settings_.direct && !indirect && !emitter.is_delta())
        light.direct = count;
    else if (settings_.direct)
        light.direct = useful_samples(emitter, std::uint32_t(float(count) * settings_.direct_share));
    const std::uint32_t paths = indirect ? count - std::min(light.direct, count) : 0;
    light.paths.reset(EmitterSource(light.emitter), paths, hash_combine(settings_.seed, 0xd1a0u + number));
    samples_.resize(samples_.size() + light.direct + paths);
    place_direct(light, rays);
    fill_gaps(light, paths, rays);
    light.paths.share_flux(EmitterSource(light.emitter), reflected(light));
    lights_.push_back(std::move(light));
}

void DynamicLights::update(const std::vector<Emitter>& emitters, const raytrace::RayScene& rays) {
    moved_.assign(samples_.size(), 0);
    resampled_ = 0;
    for (std::size_t e = 0; e < lights_.size(); ++e) {
        Light& light = lights_[e];
        const bool still = light.emitter.matrix == emitters[e].matrix;
        const bool complete = light.paths.complete();
        const bool same = still && light.emitter.flux == emitters[e].flux;
        changed_ = changed_ || !same;
        if (same && complete)
            continue;
        light.emitter = emitters[e];
        place_direct(light, rays);
        if (!still)
            light.paths.validate(EmitterSource(light.emitter), rays);
        if (!still || !complete)
            fill_gaps(light, max_resampled, rays);
        light.paths.share_flux(EmitterSource(light.emitter), reflected(light));
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

void DynamicLights::fill_gaps(Light& light, std::uint32_t most, const raytrace::RayScene& rays) {
    std::span<std::uint8_t> moved;
    if (!moved_.empty())
        moved = std::span(moved_).subspan(light.first + light.direct, light.paths.size());
    const PathSpace space{settings_, rays, settings_.bounces, 1, paths_made_, moved};
    resampled_ += light.paths.fill_gaps(EmitterSource(light.emitter), most, space, reflected(light));
}

} // namespace sunfleck::gi

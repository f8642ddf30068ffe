// Light samples (VPLs) of dynamic emitters: those that move or change their strength. Samples on the emitter follow it;
// reflected ones keep their places as long as their light reaches them (followed_paths.h).
#pragma once

#include "gi_module/light_sampling/followed_paths.h"

namespace sunfleck::gi {

class DynamicLights {
public:
    // Starts over with `count` samples for all these emitters together (at least one each, so there may be more).
    void reset(const std::vector<Emitter>& emitters, std::uint32_t count, const SampleRequest& settings,
               const raytrace::RayScene& rays);
    // Follows the same emitters, in the same order. A pure function of all updates since reset.
    void update(const std::vector<Emitter>& emitters, const raytrace::RayScene& rays);

    // All `dynamic`; their number and kinds do not change until the next reset.
    const std::vector<LightSample>& samples() const { return samples_; }
    // By sample: whether position or direction changed in the last update. Flux may change with or without them.
    const std::vector<std::uint8_t>& moved() const { return moved_; }
    // Paths that were sampled again in the last update.
    std::uint32_t resampled() const { return resampled_; }
    // Whether any of them has moved or changed its flux since the reset.
    bool changed() const { return changed_; }

    static bool can_follow(EmitterKind kind) { return kind <= EmitterKind::spot; }

private:
    struct Light {
        Emitter emitter;
        std::uint32_t first = 0, direct = 0; // samples on the emitter; those of paths follow
        FollowedPaths paths;
    };
    void add_light(const Emitter& emitter, std::uint32_t number, std::uint32_t count, const raytrace::RayScene& rays);
    void place_direct(Light& light, const raytrace::RayScene& rays);
    void fill_gaps(Light& light, std::uint32_t most, const raytrace::RayScene& rays);
    std::span<LightSample> reflected(const Light& light) {
        return std::span(samples_).subspan(light.first + light.direct, light.paths.size());
    }

    SampleRequest settings_;
    std::vector<Light> lights_;
    std::vector<LightSample> samples_;
    std::vector<std::uint8_t> moved_;
    std::uint32_t resampled_ = 0, paths_made_ = 0;
    bool changed_ = false;
};

} // namespace sunfleck::gi

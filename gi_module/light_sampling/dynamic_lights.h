// Light samples (VPLs) of dynamic emitters: those that move or change their strength. Samples on the emitter follow it.
// Reflected ones keep their places as long as the first segment of their path is unoccluded; the others are sampled
// again, a few a frame, where the emitted light has the largest gap. After S. Laine et al., "Incremental Instant
// Radiosity for Real-Time Indirect Illumination", 2007, with paths of several bounces: a path is valid as a whole while
// its first segment is.
//
// Each reflected sample carries the share of the emitted flux that leaves nearer to its path's direction than to any
// other's: the Voronoi cell of the direction, measured with a fixed set of directions that are distributed like the
// emitted light.
#pragma once

#include "engine/raytrace/ray_scene.h"
#include "gi_module/light_sampling/emitters.h"
#include "gi_module/light_sampling/sampling_settings.h"

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

    static bool can_follow(EmitterKind kind) { return kind <= EmitterKind::spot; }

private:
    struct Path {
        float numbers[4] = {}; // of the emitted ray
        vec3 direction{0.0f};  // of the first segment, in the emitter's frame
        vec3 first_hit{0.0f};  // world space; far along the ray if the path hit nothing
        vec3 throughput{0.0f}; // of the whole path; the emitter's flux is not in it
        bool escaped = false, valid = false;
    };
    struct Light {
        Emitter emitter;
        std::uint32_t first = 0, direct = 0; // samples on the emitter; those of paths follow
        std::vector<Path> paths;
        std::vector<vec3> directions; // of emitted light, in the emitter's frame
        std::vector<float> weights;
        std::vector<std::array<float, 4>> numbers;
    };
    struct Cells;
    void add_light(const Emitter& emitter, std::uint32_t number, std::uint32_t count, const raytrace::RayScene& rays);
    void make_directions(Light& light, std::uint32_t seed) const;
    void place_direct(Light& light, const raytrace::RayScene& rays);
    void validate(Light& light, const raytrace::RayScene& rays) const;
    void sample_path(Light& light, std::uint32_t path, const raytrace::RayScene& rays);
    void trace_path(Path& path, LightSample& sample, raytrace::Ray ray, const raytrace::RayScene& rays);
    void fill_gaps(Light& light, std::uint32_t count, const raytrace::RayScene& rays);
    void share_flux(Light& light);

    SampleRequest settings_;
    std::vector<Light> lights_;
    std::vector<LightSample> samples_;
    std::vector<std::uint8_t> moved_;
    std::uint32_t resampled_ = 0, paths_made_ = 0;
};

} // namespace sunfleck::gi

// Light samples (virtual point lights, VPLs) on emitters and, by random walks, on static geometry: instant radiosity.
// Thesis sec. 4.1.
#pragma once

#include "engine/core/random.h"
#include "engine/raytrace/ray_scene.h"
#include "gi_module/light_sampling/emitters.h"
#include "gi_module/light_sampling/sampling_settings.h"

#include <functional>

namespace sunfleck::gi {

// How the samples are divided between direct light (samples on emitters) and reflected light.
struct SampleBudget {
    std::uint32_t direct = 0;
    std::uint32_t indirect = 0;
};
SampleBudget divide_samples(const SampleRequest& settings, const std::vector<Emitter>& emitters);

// Direct samples: point, spot and directional lights get one each; area emitters and environments share the rest in
// proportion to their flux, which is divided equally among an emitter's samples. With fewer samples than emitters, some
// emitters are picked with probability proportional to flux. The samples' flux adds up to that of all emitters, but for
// rounding.
std::vector<LightSample> sample_direct(const std::vector<Emitter>& emitters, std::uint32_t count,
                                       const SampleRequest& settings, const raytrace::RayScene& rays);

// Indirect samples: random walks start at an emitter chosen by flux and leave a sample at every surface that they hit,
// with the flux that the surface reflects. Only whole walks count: they go on until there are at least `count` samples;
// then the excess is dropped at random and the flux of the rest scaled up, so that no bounce is favoured (stopping in
// the middle of a walk, as the thesis does, favours early ones). The result does not depend on the number of threads.
// `progress`: see SampleSource::make.
std::vector<LightSample> sample_indirect(const std::vector<Emitter>& emitters, std::uint32_t count,
                                         const SampleRequest& settings, const raytrace::RayScene& rays,
                                         const std::function<bool(float)>& progress = {});

// Sample `index` of `count` of one emitter's direct light. Its position on the emitter does not change when the emitter
// moves. Those of a ball that moves are points within it, which its own surface does not shadow.
LightSample make_direct_sample(const Emitter& emitter, std::uint32_t index, std::uint32_t count,
                               const SampleRequest& settings, const raytrace::RayScene& rays);
// How many of `share` samples make_direct_sample can use; the rest may serve reflected light.
std::uint32_t useful_samples(const Emitter& emitter, std::uint32_t share);

// Of a path that holds as many as it can, the oldest vertex is dropped.
void add_path_vertex(LightSample& sample, vec3 point);

// Positive integers in proportion to `weights` that add up to `count`, which is at least the number of weights.
std::vector<std::uint32_t> apportion(const std::vector<double>& weights, std::uint32_t count);

// Moves a sample off its surface: by 1 mm, but at most half the distance to the next surface.
vec3 offset_from_surface(vec3 position, vec3 normal, const raytrace::RayScene& rays, raytrace::Scope scope);

// What the samplers share.
SequenceKind sequence_kind(const SampleRequest& settings);
raytrace::Scope walk_scope(const SampleRequest& settings);
// Index of the emitter in whose part of the cumulative flux `target` lies.
std::size_t choose_emitter(const std::vector<double>& cumulative, double target);

} // namespace sunfleck::gi

// Light samples over emitters and, by random walks, over static geometry. Thesis sec. 4.1.
#pragma once

#include "engine/raytrace/ray_scene.h"
#include "gi_module/light_sampling/emitters.h"
#include "gi_module/light_sampling/sampling_settings.h"

namespace sunfleck::gi {

// How the total is divided between light straight from emitters and reflected light.
struct SampleBudget {
    std::uint32_t direct = 0;
    std::uint32_t indirect = 0;
};
SampleBudget divide_samples(const SampleRequest& settings, const std::vector<Emitter>& emitters);

// Direct samples: point, spot and directional lights take one each; area emitters and environments share the rest by
// their flux, and each emitter's samples carry equal parts of it. With fewer samples than emitters some are picked with
// probability proportional to flux. The flux of all samples is that of all emitters, exactly but for rounding.
std::vector<LightSample> sample_direct(const std::vector<Emitter>& emitters, std::uint32_t count,
                                       const SampleRequest& settings, const raytrace::RayScene& rays);

// Indirect samples: walks leave an emitter chosen by flux, and leave a sample at each surface that they meet, carrying
// what that surface reflects. Only whole walks count: as many are made as give at least `count` samples, then the
// excess is dropped at random and the rest strengthened in proportion, so no bounce is favoured (stopping inside a
// walk, as the thesis does, favours early ones). The result does not depend on the number of threads.
std::vector<LightSample> sample_indirect(const std::vector<Emitter>& emitters, std::uint32_t count,
                                         const SampleRequest& settings, const raytrace::RayScene& rays);

// Number `index` of `count` samples on one emitter: the same place on it wherever it is.
LightSample make_direct_sample(const Emitter& emitter, std::uint32_t index, std::uint32_t count,
                               const SampleRequest& settings, const raytrace::RayScene& rays);

// Whole numbers proportional to `weights`, none of them zero, that add up to `count` (at least one for each weight).
std::vector<std::uint32_t> apportion(const std::vector<double>& weights, std::uint32_t count);

// Moves a sample off its surface: 1 mm, but at most half of the way to the next surface.
vec3 offset_from_surface(vec3 position, vec3 normal, const raytrace::RayScene& rays, raytrace::Scope scope);

} // namespace sunfleck::gi

// What the bound of the geometry term (transport/clamping.h) takes away: near a surface sample the bound makes light
// darker, so a picture of few samples is a little darker than the truth as a whole. With more samples the bound rises,
// and the loss vanishes.
#pragma once

#include "engine/raytrace/ray_scene.h"
#include "gi_module/transport/light_sample.h"

#include <span>

namespace sunfleck::gi {

// The share, 0 to 1, of the static surface samples' light (luminance) that does not arrive on static geometry because
// their geometry terms are bounded by `bounds` (1/m2, one a sample): 1 - min(1, bound / term) in the mean over rays in
// the cosine lobe in which each sample radiates. Rays that leave the scene lose nothing. The same for any number of
// threads.
double clamping_loss(std::span<const LightSample> samples, std::span<const float> bounds,
                     const raytrace::RayScene& rays);

// The same share of one surface sample, by `ray_count` rays.
float clamping_loss_of(const LightSample& sample, float bound, std::size_t ray_count, const raytrace::RayScene& rays);

} // namespace sunfleck::gi

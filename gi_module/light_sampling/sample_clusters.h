// Fewer, better placed samples from many: the samples of several times as many walks are divided into clusters of like
// place and orientation, and each cluster is stood for by the sample in its middle, with the flux of all. The thesis
// suggests it in sec. 6.1 (samples spread evenly in space, weighted by the walks that reach their region); the division
// follows the global cuts of B. Walter et al., "Lightcuts", 2005.
#pragma once

#include "gi_module/transport/light_sample.h"

#include <vector>

namespace sunfleck::gi {

// At most `count` samples. Flux is kept, by channel. Where light is smooth over a cluster, its middle says more than a
// sample drawn at random (the midpoint rule; squared errors of 300 samples are a half to a third), at the price of an
// error that seeds share and that shrinks with the clusters. `spread` 0 divides where most flux is, 1 where most
// surface is. `seed` draws the ways that the light came, from the clusters' members in proportion to their luminance.
std::vector<LightSample> cluster_samples(const std::vector<LightSample>& samples, std::uint32_t count, float spread,
                                         std::uint32_t seed);

} // namespace sunfleck::gi

// Fewer, better placed light samples (VPLs): several times as many candidates are clustered by position and
// orientation, and each cluster is represented by its medoid, the candidate nearest to the flux-weighted mean, with the
// flux of all. The thesis suggests it in sec. 6.1 (samples spread evenly in space, weighted by the walks that reach
// their region); the subdivision follows the global cuts of B. Walter et al., "Lightcuts", 2005.
//
// A cluster that spans several surfaces, as in a corner, has no place that stands for all: its medoid would lie on the
// same one of them for all seeds, and the others would be dark. So small clusters are divided by surfaces first, and
// one that still spans several is represented by the medoid of one of them, drawn in proportion to its share of the
// flux. Surfaces are told apart by the samples' normals, which are those of shading: a wall with a normal map counts as
// many.
#pragma once

#include "gi_module/transport/light_sample.h"

#include <functional>
#include <vector>

namespace sunfleck::gi {

// At most `count` samples. Flux is preserved, by channel. Where light is smooth over a cluster, its medoid is more
// accurate than a member drawn at random (like the midpoint rule; squared errors of 300 samples drop to a third in the
// geometric mean of 14 rooms, AnywhereSampler in gpu_tests), at the price of a bias that all seeds share and that
// shrinks with the clusters. `spread`: 0 subdivides where most flux is, 1 where most surface is. `seed` draws the path
// of each cluster's light, and the surface that it stands on, from its members, in proportion to their luminance.
// `progress`: called with the share that is done; if it returns false, there are no samples.
std::vector<LightSample> cluster_samples(const std::vector<LightSample>& samples, std::uint32_t count, float spread,
                                         std::uint32_t seed, const std::function<bool(float)>& progress = {});

} // namespace sunfleck::gi

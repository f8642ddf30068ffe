// Which texels of a reflective shadow map a pixel looks up, as offsets from where it lies in the map itself: the same
// for all pixels. C. Dachsbacher and M. Stamminger, "Reflective Shadow Maps", I3D 2005, sec. 4.1.
#pragma once

#include "gi_module/rsm_gather/rsm_gather_shared.h"

#include <vector>

namespace sunfleck::gi {

// About `count` texels of a map of side x side, denser near the middle, in a disc of `radius` (of the map's side), in
// which the map's opposite sides meet. Each stands for as many texels as its density says, so that with a disc that
// covers the map, the mean over all seeds is the sum of all texels. At least as many as the map has: each of them once.
std::vector<shared::GatherSample> gather_pattern(std::uint32_t count, std::uint32_t side, float radius,
                                                 std::uint32_t seed, bool softening);

} // namespace sunfleck::gi

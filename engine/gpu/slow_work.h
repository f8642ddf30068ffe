// Only in builds with SUNFLECK_SLOW_WORK (CMake), which the frame-time gate tests itself with: real work in addition,
// inside the time of the pass that SUNFLECK_SLOW names. SUNFLECK_SLOW_AMOUNT is the number of work groups.
#pragma once

#include "engine/gpu/frame_graph.h"

namespace sunfleck::gpu {

Status add_slow_work(PassContext& context, const std::string& pass);

} // namespace sunfleck::gpu

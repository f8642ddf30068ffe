// Only in builds with SUNFLECK_SLOW_WORK (CMake), which the frame-time gate tests itself with: real work in addition,
// inside the times of passes. The amount (engine/core/slow_work.h) is the number of work groups of a dispatch.
#pragma once

#include "engine/gpu/frame_graph.h"

namespace sunfleck::gpu {

Status add_slow_work(PassContext& context, const std::string& pass);

} // namespace sunfleck::gpu

// Light samples (VPLs) in the form that kernels process: one dispatch per batch, whose rows fit into a uniform buffer.
#pragma once

#include "engine/gpu/frame_resources.h"
#include "gi_module/transport/light_row_shared.h"

namespace sunfleck::gi {

// At most shared::lights_per_batch consecutive samples of one class, all dynamic or all static.
struct LightBatch {
    std::uint32_t light_class = 0;
    gpu::UploadSlice rows; // LightRow[lights_per_batch], the first `count` used
    std::uint32_t first = 0;
    std::uint32_t count = 0;
    bool dynamic = false; // of emitters that move or vary: not in light maps
};

} // namespace sunfleck::gi

// Light samples as kernels take them: a dispatch handles one batch, whose rows fit a uniform buffer.
#pragma once

#include "engine/gpu/frame_resources.h"
#include "gi_module/transport/light_row_shared.h"

namespace sunfleck::gi {

// Consecutive samples of one class, all dynamic or none, at most shared::lights_per_batch of them.
struct LightBatch {
    std::uint32_t light_class = 0;
    gpu::UploadSlice rows; // LightRow[lights_per_batch], the first `count` used
    std::uint32_t first = 0;
    std::uint32_t count = 0;
    bool dynamic = false; // of moving or varying emitters: not in light maps
};

} // namespace sunfleck::gi

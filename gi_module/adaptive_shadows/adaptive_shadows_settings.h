// Settings of adaptive shadow maps.
#pragma once

#include "engine/core/description.h"

namespace sunfleck::gi {

struct AdaptiveShadowsSettings {
    float shadow_detail = 1.0f;        // texels a pixel
    float shadow_tile_memory = 128.0f; // MiB
    std::uint32_t moving_light_tiles = 4;

    static const TypeDescription& description();
};

} // namespace sunfleck::gi

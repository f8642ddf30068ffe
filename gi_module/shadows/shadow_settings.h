// Settings of shadow maps.
#pragma once

#include "engine/core/description.h"

namespace sunfleck::gi {

// contribution: by the light in the picture that the map's movers may shadow (shadows/map_contributions.h), times age;
// without a visibility database, as flux_and_age. flux_and_age: brightest channel times age, thesis sec. 4.5.3. age:
// oldest first.
enum class MapPriority : std::uint32_t { contribution, flux_and_age, age };

struct ShadowSettings {
    bool shadows = true;
    std::uint32_t shadow_map_resolution = 256;
    std::uint32_t shadow_map_bits = 16;
    float shadow_memory = 512.0f; // MiB
    bool shadow_filter = false;
    bool static_maps = true;
    bool kept_maps = false;
    bool map_detail = true;
    std::uint32_t map_budget = 80; // shadow maps a frame
    float map_milliseconds = 0.0f; // GPU time for them; 0: map_budget applies
    MapPriority map_priority = MapPriority::contribution;

    static const TypeDescription& description();
};

} // namespace sunfleck::gi

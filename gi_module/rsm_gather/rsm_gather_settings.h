// Settings of light that is gathered from reflective shadow maps.
#pragma once

#include "engine/core/description.h"

namespace sunfleck::gi {

// Whose first bounce is gathered: a short way to fill cells of the light plan. moving: emitters that move or vary, and
// what movers reflect (first_bounce.dynamic); all: every first bounce.
enum class GatherChoice : std::uint32_t { none, moving, all };

struct RsmGatherSettings {
    GatherChoice gather_lights = GatherChoice::none;
    std::uint32_t gather_samples = 256;
    std::uint32_t gather_rays = 4096;
    float gather_radius = 0.7072f; // of a map's side
    bool gather_softening = false;

    static const TypeDescription& description();
};

} // namespace sunfleck::gi

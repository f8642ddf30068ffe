// What a user can set about the many-light system alone; each part can be switched off, to see what it is worth.
#pragma once

#include "engine/core/description.h"

namespace sunfleck::gi {

struct ManyLightSettings {
    bool visibility = true;
    bool light_maps = true;
    bool baked_light = true;
    bool count_passes = false;
    std::uint32_t lights_per_pass = 7;
    bool pass_extras = true;

    static const TypeDescription& description();
};

} // namespace sunfleck::gi

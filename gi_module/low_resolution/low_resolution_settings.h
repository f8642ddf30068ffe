// What a user can set about lighting at low resolution, and its repair.
#pragma once

#include "engine/core/description.h"

namespace sunfleck::gi {

struct LowResolutionSettings {
    std::uint32_t low_resolution = 4;
    float repair_contrast = 0.3f;
    float repair_angle = 12.0f;
    bool repair_contacts = true;

    static const TypeDescription& description();
};

} // namespace sunfleck::gi

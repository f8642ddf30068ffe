// What a user can set about glossy light.
#pragma once

#include "engine/core/description.h"

namespace sunfleck::gi {

struct GlossSettings {
    std::uint32_t gloss_samples = 0; // of reflected light; 0: all

    static const TypeDescription& description();
};

} // namespace sunfleck::gi

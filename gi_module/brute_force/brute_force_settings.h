// What a user can set about the baseline alone.
#pragma once

#include "engine/core/description.h"

namespace sunfleck::gi {

struct BruteForceSettings {
    bool count_clamped = false;

    static const TypeDescription& description();
};

} // namespace sunfleck::gi

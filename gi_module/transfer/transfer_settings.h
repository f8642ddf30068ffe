// Settings of precomputed radiance transfer.
#pragma once

#include "engine/core/description.h"

namespace sunfleck::gi {

struct TransferSettings {
    std::uint32_t transfer_points = 4;      // per axis of a mover: where incident light is computed
    std::uint32_t transfer_reflections = 2; // of light from a mover onto itself

    static const TypeDescription& description();
};

} // namespace sunfleck::gi

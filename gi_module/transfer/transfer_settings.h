// What a user can set about precomputed radiance transfer.
#pragma once

#include "engine/core/description.h"

namespace sunfleck::gi {

struct TransferSettings {
    std::uint32_t transfer_points = 4;      // along each side of a mover, where its light is known
    std::uint32_t transfer_reflections = 2; // of a mover's light onto itself

    static const TypeDescription& description();
};

} // namespace sunfleck::gi

// What a user can set about the baseline alone.
#pragma once

#include "engine/core/description.h"

namespace sunfleck::gi {

// How the kernel reads lights and maps. The picture is the same; which is fastest depends on the device.
enum class KernelLights : std::uint32_t { standard, uniform, storage };
enum class KernelMaps : std::uint32_t { standard, texel, storage };

struct BruteForceSettings {
    bool count_clamped = false;
    std::uint32_t kernel_pixels = 0; // an invocation; 0: the best known number
    KernelLights kernel_lights = KernelLights::standard;
    KernelMaps kernel_maps = KernelMaps::standard;

    static const TypeDescription& description();
};

} // namespace sunfleck::gi

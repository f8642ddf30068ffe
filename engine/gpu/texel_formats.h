// Formats of texel buffers.
#pragma once

#include "engine/gpu/vulkan.h"

#include <cstdint>

namespace sunfleck::gpu {

inline std::uint64_t texel_bytes(VkFormat format) {
    switch (format) {
    case VK_FORMAT_R16_UNORM:
        return 2;
    case VK_FORMAT_R32_UINT:
    case VK_FORMAT_R32_SFLOAT:
        return 4;
    case VK_FORMAT_R32G32_UINT:
    case VK_FORMAT_R16G16B16A16_SFLOAT:
        return 8;
    default:
        return 16;
    }
}

} // namespace sunfleck::gpu

// Formats of texel buffers.
#pragma once

#include "engine/gpu/vulkan.h"

#include <bit>
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

// Bytes that a texel buffer of so many is made with. Some drivers compile a version of a kernel for each kind of size
// of what it reads, while all wait who share the queue: llvmpipe tells apart sizes that are powers of two, and, since
// it takes bits 8 to 15 for a number of levels, those where all of these are zero. No texel buffer is either.
inline std::uint64_t texel_buffer_bytes(std::uint64_t bytes) {
    constexpr std::uint64_t of_levels = 0xff00, more_levels = 0x100, a_texel = 16; // the largest
    if ((bytes & of_levels) == 0)
        bytes += more_levels;
    return std::has_single_bit(bytes) ? bytes + a_texel : bytes;
}

} // namespace sunfleck::gpu

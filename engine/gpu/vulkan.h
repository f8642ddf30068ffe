// Vulkan's types and errors. Its functions are called through tables (functions.h), never by the loader's names.
#pragma once

#ifndef VK_NO_PROTOTYPES
#define VK_NO_PROTOTYPES
#endif
#include <vulkan/vulkan_core.h>

#include "engine/core/result.h"

#include <string_view>

namespace sunfleck::gpu {

// An Error for a failed call: what was being done, the result's name, and what the user can do about it.
Error vulkan_error(VkResult result, std::string_view doing);

} // namespace sunfleck::gpu

// Returns an error from the enclosing function if the Vulkan call did not succeed.
#define SUNFLECK_VK(call, doing)                                                                                       \
    do {                                                                                                               \
        if (const VkResult sunfleck_vk_result = (call); sunfleck_vk_result < 0)                                        \
            return ::sunfleck::gpu::vulkan_error(sunfleck_vk_result, doing);                                           \
    } while (false)

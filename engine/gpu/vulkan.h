// Vulkan through volk's tables of functions: no global device, so two devices live side by side in one process.
#pragma once

#ifndef VK_NO_PROTOTYPES
#define VK_NO_PROTOTYPES
#endif
// volk's globals bear the names of the loader's functions. In a program that links the loader, too, the program's own
// calls would land in them; so ours have names of their own (made from volk.h when the project is configured).
#include <sunfleck_vulkan_names.h>

#include <volk.h>

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

// A named range of commands in captures and validation messages. Nothing without VK_EXT_debug_utils.
#pragma once

#include "engine/gpu/device.h"

#include <string>

namespace sunfleck::gpu {

// Open from construction to destruction.
class DebugLabel {
public:
    DebugLabel(const Device& device, VkCommandBuffer commands, const std::string& name);
    ~DebugLabel();
    DebugLabel(const DebugLabel&) = delete;
    DebugLabel& operator=(const DebugLabel&) = delete;

private:
    VkCommandBuffer commands_ = VK_NULL_HANDLE; // null: labels are off
    PFN_vkCmdEndDebugUtilsLabelEXT end_ = nullptr;
};

} // namespace sunfleck::gpu

#include "engine/gpu/debug_label.h"

namespace sunfleck::gpu {

DebugLabel::DebugLabel(const Device& device, VkCommandBuffer commands, const std::string& name) {
    if (!device.debug_labels() || vkCmdBeginDebugUtilsLabelEXT == nullptr || vkCmdEndDebugUtilsLabelEXT == nullptr)
        return;
    commands_ = commands;
    VkDebugUtilsLabelEXT label{VK_STRUCTURE_TYPE_DEBUG_UTILS_LABEL_EXT};
    label.pLabelName = name.c_str();
    vkCmdBeginDebugUtilsLabelEXT(commands_, &label);
}

DebugLabel::~DebugLabel() {
    if (commands_ != VK_NULL_HANDLE)
        vkCmdEndDebugUtilsLabelEXT(commands_);
}

} // namespace sunfleck::gpu

#include "engine/gpu/debug_label.h"

namespace sunfleck::gpu {

DebugLabel::DebugLabel(const Device& device, VkCommandBuffer commands, const std::string& name) {
    const InstanceFunctions& vk = device.instance_vk();
    if (!device.debug_labels() || vk.vkCmdBeginDebugUtilsLabelEXT == nullptr ||
        vk.vkCmdEndDebugUtilsLabelEXT == nullptr)
        return;
    commands_ = commands;
    end_ = vk.vkCmdEndDebugUtilsLabelEXT;
    VkDebugUtilsLabelEXT label{VK_STRUCTURE_TYPE_DEBUG_UTILS_LABEL_EXT};
    label.pLabelName = name.c_str();
    vk.vkCmdBeginDebugUtilsLabelEXT(commands_, &label);
}

DebugLabel::~DebugLabel() {
    if (commands_ != VK_NULL_HANDLE)
        end_(commands_);
}

} // namespace sunfleck::gpu

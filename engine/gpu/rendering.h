// Small helpers for passes that draw.
#pragma once

#include "engine/gpu/vulkan.h"

namespace sunfleck::gpu {

// An attachment that is kept after the pass; cleared to zero before it unless `load`.
inline VkRenderingAttachmentInfo rendering_attachment(VkImageView view, VkImageLayout layout, bool load = false) {
    VkRenderingAttachmentInfo info{VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
    info.imageView = view;
    info.imageLayout = layout;
    info.loadOp = load ? VK_ATTACHMENT_LOAD_OP_LOAD : VK_ATTACHMENT_LOAD_OP_CLEAR;
    info.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
    return info;
}

// Begins rendering onto attachments of this size; draws change only the rendering's area of them.
inline void begin_rendering(const DeviceFunctions& vk, VkCommandBuffer commands, const VkRenderingInfo& rendering,
                            std::uint32_t width, std::uint32_t height) {
    vk.vkCmdBeginRendering(commands, &rendering);
    const VkViewport viewport{0, 0, float(width), float(height), 0, 1};
    vk.vkCmdSetViewport(commands, 0, 1, &viewport);
    vk.vkCmdSetScissor(commands, 0, 1, &rendering.renderArea);
}

} // namespace sunfleck::gpu

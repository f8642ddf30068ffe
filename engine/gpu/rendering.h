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

} // namespace sunfleck::gpu

#pragma once

#include "engine/gpu/vulkan.h"

namespace sunfleck::gpu {

// What was last done to a resource on the GPU, as far as barriers need to know.
struct ResourceState {
    VkPipelineStageFlags2 write_stages = 0; // of the last write, or of the layout change after it
    VkAccessFlags2 write_access = 0;
    VkPipelineStageFlags2 read_stages = 0; // reads since, which the write is visible to
    VkAccessFlags2 read_access = 0;
    VkImageLayout layout = VK_IMAGE_LAYOUT_UNDEFINED;
};

} // namespace sunfleck::gpu

// What a pass does with a resource, and the barrier that this needs after what was done to it before.
#pragma once

#include "engine/gpu/resource_state.h"

#include <cstdint>
#include <string>

namespace sunfleck::gpu {

// What a pass does with a resource; fixes stages, access and image layout.
enum class Usage {
    colour_attachment,
    depth_attachment,
    sampled,       // by fragment or compute shaders
    storage_read,  // buffers and storage images, by any shader
    storage_write, // by compute shaders; all or part is written, nothing read
    storage_read_write,
    uniform_read,
    texel_read,
    vertex_read,
    index_read,
    indirect_read,
    transfer_source,
    transfer_destination,
    blit_source,
    blit_destination,
    host_read,
    present,
    host, // what ImportedImage::exit_... says; for exits only
};

struct UsageTraits {
    const char* name;
    VkPipelineStageFlags2 stages;
    VkAccessFlags2 access;
    VkImageLayout layout;
    VkImageUsageFlags image_usage;
};
UsageTraits traits_of(Usage usage);

struct PassBarrier {
    std::string resource;
    VkPipelineStageFlags2 source_stages = 0, destination_stages = 0;
    VkAccessFlags2 source_access = 0, destination_access = 0;
    VkImageLayout old_layout = VK_IMAGE_LAYOUT_UNDEFINED, new_layout = VK_IMAGE_LAYOUT_UNDEFINED;
    std::uint32_t resource_index = 0;
    bool is_image = false;
};

// Advances `state` over one access; returns true and fills `barrier` if one is needed.
bool advance(ResourceState& state, const UsageTraits& usage, bool write, bool is_image, PassBarrier& barrier);

} // namespace sunfleck::gpu

#include "engine/gpu/barriers.h"

namespace sunfleck::gpu {
namespace {

constexpr VkPipelineStageFlags2 shaders = VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT |
                                          VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT |
                                          VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;

} // namespace

UsageTraits traits_of(Usage usage) {
    switch (usage) {
    case Usage::colour_attachment:
        return {"colour attachment", VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
                VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT,
                VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT};
    case Usage::depth_attachment:
        return {"depth attachment",
                VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT,
                VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT | VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT,
                VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT};
    case Usage::sampled:
        return {"sampled", VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT | VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                VK_ACCESS_2_SHADER_SAMPLED_READ_BIT, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
                VK_IMAGE_USAGE_SAMPLED_BIT};
    case Usage::storage_read:
        return {"storage read", shaders, VK_ACCESS_2_SHADER_STORAGE_READ_BIT, VK_IMAGE_LAYOUT_GENERAL,
                VK_IMAGE_USAGE_STORAGE_BIT};
    case Usage::storage_write:
        return {"storage write", VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT,
                VK_IMAGE_LAYOUT_GENERAL, VK_IMAGE_USAGE_STORAGE_BIT};
    case Usage::storage_read_write:
        return {"storage read and write", VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT, VK_IMAGE_LAYOUT_GENERAL,
                VK_IMAGE_USAGE_STORAGE_BIT};
    case Usage::uniform_read:
        return {"uniform", shaders, VK_ACCESS_2_UNIFORM_READ_BIT, VK_IMAGE_LAYOUT_UNDEFINED, 0};
    case Usage::texel_read:
        return {"texels", shaders, VK_ACCESS_2_SHADER_SAMPLED_READ_BIT, VK_IMAGE_LAYOUT_UNDEFINED, 0};
    case Usage::vertex_read:
        return {"vertices", VK_PIPELINE_STAGE_2_VERTEX_INPUT_BIT, VK_ACCESS_2_VERTEX_ATTRIBUTE_READ_BIT,
                VK_IMAGE_LAYOUT_UNDEFINED, 0};
    case Usage::index_read:
        return {"indices", VK_PIPELINE_STAGE_2_VERTEX_INPUT_BIT, VK_ACCESS_2_INDEX_READ_BIT, VK_IMAGE_LAYOUT_UNDEFINED,
                0};
    case Usage::indirect_read:
        return {"indirect", VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT, VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT,
                VK_IMAGE_LAYOUT_UNDEFINED, 0};
    case Usage::transfer_source:
        return {"copy source", VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_READ_BIT,
                VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_IMAGE_USAGE_TRANSFER_SRC_BIT};
    case Usage::transfer_destination:
        return {"copy destination", VK_PIPELINE_STAGE_2_COPY_BIT | VK_PIPELINE_STAGE_2_CLEAR_BIT,
                VK_ACCESS_2_TRANSFER_WRITE_BIT, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_USAGE_TRANSFER_DST_BIT};
    case Usage::blit_source:
        return {"blit source", VK_PIPELINE_STAGE_2_BLIT_BIT, VK_ACCESS_2_TRANSFER_READ_BIT,
                VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_IMAGE_USAGE_TRANSFER_SRC_BIT};
    case Usage::blit_destination:
        return {"blit destination", VK_PIPELINE_STAGE_2_BLIT_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_USAGE_TRANSFER_DST_BIT};
    case Usage::host_read:
        return {"host read", VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT, VK_IMAGE_LAYOUT_GENERAL, 0};
    case Usage::host:
        return {"host", 0, 0, VK_IMAGE_LAYOUT_UNDEFINED, 0};
    case Usage::present:
        return {"present", VK_PIPELINE_STAGE_2_NONE, 0, VK_IMAGE_LAYOUT_PRESENT_SRC_KHR, 0};
    }
    return {};
}

bool advance(ResourceState& state, const UsageTraits& usage, bool write, bool is_image, PassBarrier& barrier) {
    const bool change_layout = is_image && state.layout != usage.layout;
    barrier.destination_stages = usage.stages;
    barrier.destination_access = usage.access;
    barrier.old_layout = state.layout;
    barrier.new_layout = is_image ? usage.layout : VK_IMAGE_LAYOUT_UNDEFINED;
    if (write || change_layout) {
        barrier.source_stages = state.write_stages | state.read_stages;
        barrier.source_access = state.write_access;
        const bool needed = change_layout || barrier.source_stages != 0;
        // A layout change is itself a write, finished when the destination stages start.
        state.write_stages = usage.stages;
        state.write_access = write ? usage.access : 0;
        state.read_stages = write ? 0 : usage.stages;
        state.read_access = write ? 0 : usage.access;
        state.layout = is_image ? usage.layout : VK_IMAGE_LAYOUT_UNDEFINED;
        return needed;
    }
    const bool visible =
        (state.read_stages & usage.stages) == usage.stages && (state.read_access & usage.access) == usage.access;
    barrier.source_stages = state.write_stages;
    barrier.source_access = state.write_access;
    const bool needed = !visible && state.write_stages != 0;
    state.read_stages |= usage.stages;
    state.read_access |= usage.access;
    return needed;
}

} // namespace sunfleck::gpu

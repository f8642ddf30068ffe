// In which states a host's images may be found and left: what Vulkan's rules say of layouts, stages and accesses, as
// far as it does not depend on how the image was made.
#include "gi_module/host_context.h"

#include <algorithm>
#include <cstdio>

namespace sunfleck::host {
namespace {

constexpr VkPipelineStageFlags2 shaders =
    VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT | VK_PIPELINE_STAGE_2_TESSELLATION_CONTROL_SHADER_BIT |
    VK_PIPELINE_STAGE_2_TESSELLATION_EVALUATION_SHADER_BIT | VK_PIPELINE_STAGE_2_GEOMETRY_SHADER_BIT |
    VK_PIPELINE_STAGE_2_PRE_RASTERIZATION_SHADERS_BIT | VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT |
    VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_2_TASK_SHADER_BIT_EXT |
    VK_PIPELINE_STAGE_2_MESH_SHADER_BIT_EXT | VK_PIPELINE_STAGE_2_RAY_TRACING_SHADER_BIT_KHR;
constexpr VkPipelineStageFlags2 vertices = VK_PIPELINE_STAGE_2_VERTEX_INPUT_BIT | VK_PIPELINE_STAGE_2_INDEX_INPUT_BIT |
                                           VK_PIPELINE_STAGE_2_VERTEX_ATTRIBUTE_INPUT_BIT;
constexpr VkPipelineStageFlags2 fragment_tests =
    VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT;
constexpr VkPipelineStageFlags2 transfers = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT | VK_PIPELINE_STAGE_2_COPY_BIT |
                                            VK_PIPELINE_STAGE_2_RESOLVE_BIT | VK_PIPELINE_STAGE_2_BLIT_BIT;
constexpr VkPipelineStageFlags2 known_stages =
    shaders | vertices | fragment_tests | transfers | VK_PIPELINE_STAGE_2_CLEAR_BIT |
    VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT | VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT |
    VK_PIPELINE_STAGE_2_TOP_OF_PIPE_BIT | VK_PIPELINE_STAGE_2_BOTTOM_OF_PIPE_BIT | VK_PIPELINE_STAGE_2_HOST_BIT |
    VK_PIPELINE_STAGE_2_ALL_GRAPHICS_BIT | VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;

// Vulkan's table of the stages that can make an access, for single stages; all graphics stages and all commands stand
// for theirs.
struct Access {
    VkAccessFlags2 accesses;
    VkPipelineStageFlags2 stages;
};
constexpr VkPipelineStageFlags2 all = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
constexpr VkPipelineStageFlags2 graphics = VK_PIPELINE_STAGE_2_ALL_GRAPHICS_BIT | all;
constexpr Access table[] = {
    {VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT, VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT | graphics},
    {VK_ACCESS_2_INDEX_READ_BIT, VK_PIPELINE_STAGE_2_VERTEX_INPUT_BIT | VK_PIPELINE_STAGE_2_INDEX_INPUT_BIT | graphics},
    {VK_ACCESS_2_VERTEX_ATTRIBUTE_READ_BIT,
     VK_PIPELINE_STAGE_2_VERTEX_INPUT_BIT | VK_PIPELINE_STAGE_2_VERTEX_ATTRIBUTE_INPUT_BIT | graphics},
    {VK_ACCESS_2_UNIFORM_READ_BIT | VK_ACCESS_2_SHADER_READ_BIT | VK_ACCESS_2_SHADER_WRITE_BIT |
         VK_ACCESS_2_SHADER_SAMPLED_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_READ_BIT |
         VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT,
     shaders | graphics},
    {VK_ACCESS_2_INPUT_ATTACHMENT_READ_BIT, VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT | graphics},
    {VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT,
     VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT | graphics},
    {VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT | VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT,
     fragment_tests | graphics},
    {VK_ACCESS_2_TRANSFER_READ_BIT, transfers | all},
    {VK_ACCESS_2_TRANSFER_WRITE_BIT, transfers | VK_PIPELINE_STAGE_2_CLEAR_BIT | all},
    {VK_ACCESS_2_HOST_READ_BIT | VK_ACCESS_2_HOST_WRITE_BIT, VK_PIPELINE_STAGE_2_HOST_BIT | all},
};

std::string hexadecimal(std::uint64_t value) {
    char text[32];
    std::snprintf(text, sizeof text, "0x%llx", static_cast<unsigned long long>(value));
    return text;
}

// Accesses of `access` that no stage of `stages` can make.
VkAccessFlags2 impossible(VkAccessFlags2 access, VkPipelineStageFlags2 stages) {
    access &= ~(VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT); // of any stages, and of none
    for (const Access& entry : table)
        if ((entry.stages & stages) != 0)
            access &= ~entry.accesses;
    return access;
}

bool is_one_of(VkImageLayout layout, std::initializer_list<VkImageLayout> list) {
    return std::find(list.begin(), list.end(), layout) != list.end();
}

// Any layout of Vulkan 1.3 but the swapchain's.
bool is_known(VkImageLayout layout) {
    return (layout >= VK_IMAGE_LAYOUT_UNDEFINED && layout <= VK_IMAGE_LAYOUT_PREINITIALIZED) ||
           is_one_of(layout, {VK_IMAGE_LAYOUT_DEPTH_READ_ONLY_STENCIL_ATTACHMENT_OPTIMAL,
                              VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_STENCIL_READ_ONLY_OPTIMAL,
                              VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL, VK_IMAGE_LAYOUT_DEPTH_READ_ONLY_OPTIMAL,
                              VK_IMAGE_LAYOUT_STENCIL_ATTACHMENT_OPTIMAL, VK_IMAGE_LAYOUT_STENCIL_READ_ONLY_OPTIMAL,
                              VK_IMAGE_LAYOUT_READ_ONLY_OPTIMAL, VK_IMAGE_LAYOUT_ATTACHMENT_OPTIMAL});
}

// Barriers are about all aspects of an image.
bool fits(VkImageLayout layout, VkFormat format) {
    const VkImageAspectFlags aspects = gpu::Image::aspect_of(format);
    const bool for_depth_alone =
        is_one_of(layout, {VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL, VK_IMAGE_LAYOUT_DEPTH_READ_ONLY_OPTIMAL});
    const bool for_both = is_one_of(layout, {VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL,
                                             VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL,
                                             VK_IMAGE_LAYOUT_DEPTH_READ_ONLY_STENCIL_ATTACHMENT_OPTIMAL,
                                             VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_STENCIL_READ_ONLY_OPTIMAL});
    if (is_one_of(layout, {VK_IMAGE_LAYOUT_STENCIL_ATTACHMENT_OPTIMAL, VK_IMAGE_LAYOUT_STENCIL_READ_ONLY_OPTIMAL}))
        return false;
    if (aspects == VK_IMAGE_ASPECT_COLOR_BIT)
        return !for_depth_alone && !for_both;
    return layout != VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL &&
           !(for_depth_alone && (aspects & VK_IMAGE_ASPECT_STENCIL_BIT) != 0);
}

} // namespace

Status check_image_state(const std::string& what, const ImageState& state, VkFormat format) {
    if (!is_known(state.layout))
        return wrong(what + " has the layout " + std::to_string(state.layout) + ", which is none of Vulkan 1.3");
    if (!fits(state.layout, format))
        return wrong(what + " has the layout " + std::to_string(state.layout) +
                     ", which is none of an image of the format " + std::to_string(format) + " (VkFormat)");
    if (const VkPipelineStageFlags2 unknown = state.stages & ~known_stages; unknown != 0)
        return wrong(what + " has the stages " + hexadecimal(state.stages) + "; " + hexadecimal(unknown) +
                     " are none of Vulkan 1.3, of mesh shaders and of ray tracing");
    if (const VkAccessFlags2 rest = impossible(state.access, state.stages); rest != 0)
        return wrong(what + " has the access " + hexadecimal(state.access) + ", of which " + hexadecimal(rest) +
                     " is of none of its stages " + hexadecimal(state.stages));
    return {};
}

} // namespace sunfleck::host

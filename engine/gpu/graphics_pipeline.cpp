// The fixed-function state of graphics pipelines.
#include "engine/gpu/pipeline.h"

#include <algorithm>

namespace sunfleck::gpu {
namespace {

struct VertexInput {
    explicit VertexInput(const std::vector<VertexAttribute>& described) {
        for (std::uint32_t i = 0; i < described.size(); ++i) {
            const VertexAttribute& attribute = described[i];
            attributes.push_back({i, attribute.buffer, attribute.format, attribute.offset});
            const auto same = [&](const auto& buffer) { return buffer.binding == attribute.buffer; };
            if (std::none_of(buffers.begin(), buffers.end(), same))
                buffers.push_back(
                    {attribute.buffer, attribute.stride,
                     attribute.per_instance ? VK_VERTEX_INPUT_RATE_INSTANCE : VK_VERTEX_INPUT_RATE_VERTEX});
        }
        info.vertexBindingDescriptionCount = std::uint32_t(buffers.size());
        info.pVertexBindingDescriptions = buffers.data();
        info.vertexAttributeDescriptionCount = std::uint32_t(attributes.size());
        info.pVertexAttributeDescriptions = attributes.data();
    }
    VertexInput(const VertexInput&) = delete;
    VertexInput& operator=(const VertexInput&) = delete;
    std::vector<VkVertexInputBindingDescription> buffers;
    std::vector<VkVertexInputAttributeDescription> attributes;
    VkPipelineVertexInputStateCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
};

VkPipelineRasterizationStateCreateInfo rasterization(const GraphicsDescription& description) {
    VkPipelineRasterizationStateCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO};
    info.cullMode = description.cull;
    info.frontFace = VK_FRONT_FACE_COUNTER_CLOCKWISE;
    info.depthClampEnable = description.depth_clamp;
    info.lineWidth = 1.0f;
    return info;
}

VkPipelineDepthStencilStateCreateInfo depth_test(const GraphicsDescription& description) {
    VkPipelineDepthStencilStateCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO};
    info.depthTestEnable = description.depth_format != VK_FORMAT_UNDEFINED;
    info.depthWriteEnable = description.depth_write;
    info.depthCompareOp = description.depth_compare;
    return info;
}

VkPipelineColorBlendAttachmentState blending(const GraphicsDescription& description) {
    VkPipelineColorBlendAttachmentState state{};
    state.colorWriteMask = description.colour_write ? 0xf : 0;
    if (!description.blend)
        return state;
    state.blendEnable = VK_TRUE;
    state.srcColorBlendFactor = VK_BLEND_FACTOR_SRC_ALPHA;
    state.dstColorBlendFactor = VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA;
    state.srcAlphaBlendFactor = VK_BLEND_FACTOR_ONE;
    state.dstAlphaBlendFactor = VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA;
    return state;
}

VkPipelineShaderStageCreateInfo stage_info(VkShaderModule module, VkShaderStageFlagBits stage,
                                           const SpecializationValues& specialization) {
    VkPipelineShaderStageCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO};
    info.stage = stage;
    info.module = module;
    info.pName = "main";
    info.pSpecializationInfo = &specialization.info;
    return info;
}

// All but the stages and the layout.
VkResult create_pipeline(Device& device, const GraphicsDescription& description, VkGraphicsPipelineCreateInfo info,
                         VkPipeline& handle) {
    const VertexInput vertex(description.attributes);
    VkPipelineInputAssemblyStateCreateInfo assembly{VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO};
    assembly.topology = description.topology;
    VkPipelineViewportStateCreateInfo viewport{VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO};
    viewport.viewportCount = 1;
    viewport.scissorCount = 1;
    const VkPipelineRasterizationStateCreateInfo raster = rasterization(description);
    VkPipelineMultisampleStateCreateInfo multisample{VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO};
    multisample.rasterizationSamples = VkSampleCountFlagBits(description.samples);
    const VkPipelineDepthStencilStateCreateInfo depth = depth_test(description);
    const std::vector<VkPipelineColorBlendAttachmentState> blends(description.colour_formats.size(),
                                                                  blending(description));
    VkPipelineColorBlendStateCreateInfo blend{VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO};
    blend.attachmentCount = std::uint32_t(blends.size());
    blend.pAttachments = blends.data();
    const VkDynamicState dynamic_states[] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR,
                                             VK_DYNAMIC_STATE_CULL_MODE, VK_DYNAMIC_STATE_FRONT_FACE};
    VkPipelineDynamicStateCreateInfo dynamic{VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO};
    dynamic.dynamicStateCount = description.dynamic_cull ? 4 : 2;
    dynamic.pDynamicStates = dynamic_states;
    VkPipelineRenderingCreateInfo rendering{VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO};
    rendering.colorAttachmentCount = std::uint32_t(description.colour_formats.size());
    rendering.pColorAttachmentFormats = description.colour_formats.data();
    rendering.depthAttachmentFormat = description.depth_format;

    info.pNext = &rendering;
    info.pVertexInputState = &vertex.info;
    info.pInputAssemblyState = &assembly;
    info.pViewportState = &viewport;
    info.pRasterizationState = &raster;
    info.pMultisampleState = &multisample;
    info.pDepthStencilState = &depth;
    info.pColorBlendState = &blend;
    info.pDynamicState = &dynamic;
    return device.vk.vkCreateGraphicsPipelines(device.handle(), VK_NULL_HANDLE, 1, &info, nullptr, &handle);
}

} // namespace

Result<VkPipeline> PipelineStore::build_graphics(const Entry& entry, VkPipelineLayout layout) {
    const GraphicsDescription& description = entry.graphics;
    const SpecializationValues specialization(description.specialization);
    std::vector<ShaderModule> modules;
    std::vector<VkPipelineShaderStageCreateInfo> stages;
    const auto add_stage = [&](const std::string& path, VkShaderStageFlagBits stage) -> Status {
        SUNFLECK_ASSIGN(ShaderModule module, make_module(path));
        modules.push_back(std::move(module));
        stages.push_back(stage_info(modules.back().handle, stage, specialization));
        return {};
    };
    SUNFLECK_TRY(add_stage(description.vertex_shader, VK_SHADER_STAGE_VERTEX_BIT));
    if (!description.fragment_shader.empty())
        SUNFLECK_TRY(add_stage(description.fragment_shader, VK_SHADER_STAGE_FRAGMENT_BIT));
    VkGraphicsPipelineCreateInfo info{VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO};
    info.stageCount = std::uint32_t(stages.size());
    info.pStages = stages.data();
    info.layout = layout;
    VkPipeline handle = VK_NULL_HANDLE;
    SUNFLECK_VK(create_pipeline(device_, description, info, handle),
                "creating graphics pipeline '" + description.vertex_shader + "'");
    return handle;
}

} // namespace sunfleck::gpu

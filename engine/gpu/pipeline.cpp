#include "engine/gpu/pipeline.h"

#include <algorithm>

namespace sunfleck::gpu {
namespace {

VkDescriptorType descriptor_type(BindingKind kind) {
    switch (kind) {
    case BindingKind::uniform_buffer:
        return VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
    case BindingKind::storage_buffer:
        return VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    case BindingKind::texel_buffer:
        return VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER;
    case BindingKind::storage_image:
        return VK_DESCRIPTOR_TYPE_STORAGE_IMAGE;
    case BindingKind::sampled_image:
        return VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
    }
    return VK_DESCRIPTOR_TYPE_MAX_ENUM;
}

// Constant ids 0, 1, ... with 32-bit values, as VkSpecializationInfo wants them.
struct Specialization {
    explicit Specialization(const std::vector<std::uint32_t>& values) {
        for (std::uint32_t i = 0; i < values.size(); ++i)
            entries.push_back({i, i * 4, 4});
        info = {std::uint32_t(entries.size()), entries.data(), values.size() * 4, values.data()};
    }
    std::vector<VkSpecializationMapEntry> entries;
    VkSpecializationInfo info{};
};

} // namespace

PipelineStore::~PipelineStore() {
    for (const auto& entry : entries_)
        destroy(*entry);
}

void PipelineStore::destroy(Entry& entry) {
    device_.vk.vkDestroyPipeline(device_.handle(), entry.pipeline.handle_, nullptr);
    device_.vk.vkDestroyPipelineLayout(device_.handle(), entry.pipeline.layout_, nullptr);
    device_.vk.vkDestroyDescriptorSetLayout(device_.handle(), entry.pipeline.set_layout_, nullptr);
}

Result<VkShaderModule> PipelineStore::make_module(const std::string& path) {
    SUNFLECK_ASSIGN(const auto words, shaders_.find(path));
    VkShaderModuleCreateInfo info{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
    info.codeSize = words.size_bytes();
    info.pCode = words.data();
    VkShaderModule module = VK_NULL_HANDLE;
    SUNFLECK_VK(device_.vk.vkCreateShaderModule(device_.handle(), &info, nullptr, &module),
                "creating shader '" + path + "'");
    return module;
}

Status PipelineStore::make_layout(Pipeline& pipeline, const std::vector<BindingKind>& bindings,
                                  std::uint32_t push_bytes, VkShaderStageFlags stages) {
    pipeline.bindings_ = bindings;
    pipeline.push_stages_ = push_bytes > 0 ? stages : 0;
    std::vector<VkDescriptorSetLayoutBinding> set;
    for (std::uint32_t i = 0; i < bindings.size(); ++i)
        set.push_back({i, descriptor_type(bindings[i]), 1, stages, nullptr});
    VkDescriptorSetLayoutCreateInfo set_info{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
    set_info.bindingCount = std::uint32_t(set.size());
    set_info.pBindings = set.data();
    SUNFLECK_VK(device_.vk.vkCreateDescriptorSetLayout(device_.handle(), &set_info, nullptr, &pipeline.set_layout_),
                "creating a descriptor set layout");
    const VkPushConstantRange range{stages, 0, push_bytes};
    VkPipelineLayoutCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
    info.setLayoutCount = 1;
    info.pSetLayouts = &pipeline.set_layout_;
    info.pushConstantRangeCount = push_bytes > 0 ? 1 : 0;
    info.pPushConstantRanges = &range;
    SUNFLECK_VK(device_.vk.vkCreatePipelineLayout(device_.handle(), &info, nullptr, &pipeline.layout_),
                "creating a pipeline layout");
    return {};
}

Result<VkPipeline> PipelineStore::build_compute(const Entry& entry) {
    SUNFLECK_ASSIGN(const VkShaderModule module, make_module(entry.compute.shader));
    const Specialization specialization(entry.compute.specialization);
    VkComputePipelineCreateInfo info{VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO};
    info.stage = {VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO};
    info.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
    info.stage.module = module;
    info.stage.pName = "main";
    info.stage.pSpecializationInfo = &specialization.info;
    info.layout = entry.pipeline.layout_;
    VkPipeline handle = VK_NULL_HANDLE;
    const VkResult result =
        device_.vk.vkCreateComputePipelines(device_.handle(), VK_NULL_HANDLE, 1, &info, nullptr, &handle);
    device_.vk.vkDestroyShaderModule(device_.handle(), module, nullptr);
    SUNFLECK_VK(result, "creating compute pipeline '" + entry.compute.shader + "'");
    return handle;
}

Result<VkPipeline> PipelineStore::build_graphics(const Entry& entry) {
    const GraphicsDescription& d = entry.graphics;
    const Specialization specialization(d.specialization);
    std::vector<VkPipelineShaderStageCreateInfo> stages;
    const auto add_stage = [&](const std::string& path, VkShaderStageFlagBits stage) -> Status {
        SUNFLECK_ASSIGN(const VkShaderModule module, make_module(path));
        VkPipelineShaderStageCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO};
        info.stage = stage;
        info.module = module;
        info.pName = "main";
        info.pSpecializationInfo = &specialization.info;
        stages.push_back(info);
        return {};
    };
    Status status = add_stage(d.vertex_shader, VK_SHADER_STAGE_VERTEX_BIT);
    if (status && !d.fragment_shader.empty())
        status = add_stage(d.fragment_shader, VK_SHADER_STAGE_FRAGMENT_BIT);

    std::vector<VkVertexInputBindingDescription> buffers;
    std::vector<VkVertexInputAttributeDescription> attributes;
    for (std::uint32_t i = 0; i < d.attributes.size(); ++i) {
        const VertexAttribute& attribute = d.attributes[i];
        attributes.push_back({i, attribute.buffer, attribute.format, attribute.offset});
        if (std::none_of(buffers.begin(), buffers.end(),
                         [&](const auto& buffer) { return buffer.binding == attribute.buffer; }))
            buffers.push_back({attribute.buffer, attribute.stride,
                               attribute.per_instance ? VK_VERTEX_INPUT_RATE_INSTANCE : VK_VERTEX_INPUT_RATE_VERTEX});
    }
    VkPipelineVertexInputStateCreateInfo vertex{VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
    vertex.vertexBindingDescriptionCount = std::uint32_t(buffers.size());
    vertex.pVertexBindingDescriptions = buffers.data();
    vertex.vertexAttributeDescriptionCount = std::uint32_t(attributes.size());
    vertex.pVertexAttributeDescriptions = attributes.data();
    VkPipelineInputAssemblyStateCreateInfo assembly{VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO};
    assembly.topology = d.topology;
    VkPipelineViewportStateCreateInfo viewport{VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO};
    viewport.viewportCount = 1;
    viewport.scissorCount = 1;
    VkPipelineRasterizationStateCreateInfo raster{VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO};
    raster.cullMode = d.cull;
    raster.frontFace = VK_FRONT_FACE_COUNTER_CLOCKWISE;
    raster.depthClampEnable = d.depth_clamp;
    raster.lineWidth = 1.0f;
    VkPipelineMultisampleStateCreateInfo multisample{VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO};
    multisample.rasterizationSamples = VK_SAMPLE_COUNT_1_BIT;
    VkPipelineDepthStencilStateCreateInfo depth{VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO};
    depth.depthTestEnable = d.depth_format != VK_FORMAT_UNDEFINED;
    depth.depthWriteEnable = d.depth_write;
    depth.depthCompareOp = d.depth_compare;
    VkPipelineColorBlendAttachmentState plain{};
    plain.colorWriteMask = 0xf;
    if (d.blend) {
        plain.blendEnable = VK_TRUE;
        plain.srcColorBlendFactor = VK_BLEND_FACTOR_SRC_ALPHA;
        plain.dstColorBlendFactor = VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA;
        plain.srcAlphaBlendFactor = VK_BLEND_FACTOR_ONE;
        plain.dstAlphaBlendFactor = VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA;
    }
    const std::vector<VkPipelineColorBlendAttachmentState> blends(d.colour_formats.size(), plain);
    VkPipelineColorBlendStateCreateInfo blend{VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO};
    blend.attachmentCount = std::uint32_t(blends.size());
    blend.pAttachments = blends.data();
    const VkDynamicState dynamic_states[] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR,
                                             VK_DYNAMIC_STATE_CULL_MODE, VK_DYNAMIC_STATE_FRONT_FACE};
    VkPipelineDynamicStateCreateInfo dynamic{VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO};
    dynamic.dynamicStateCount = d.dynamic_cull ? 4 : 2;
    dynamic.pDynamicStates = dynamic_states;
    VkPipelineRenderingCreateInfo rendering{VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO};
    rendering.colorAttachmentCount = std::uint32_t(d.colour_formats.size());
    rendering.pColorAttachmentFormats = d.colour_formats.data();
    rendering.depthAttachmentFormat = d.depth_format;

    VkGraphicsPipelineCreateInfo info{VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO, &rendering};
    info.stageCount = std::uint32_t(stages.size());
    info.pStages = stages.data();
    info.pVertexInputState = &vertex;
    info.pInputAssemblyState = &assembly;
    info.pViewportState = &viewport;
    info.pRasterizationState = &raster;
    info.pMultisampleState = &multisample;
    info.pDepthStencilState = &depth;
    info.pColorBlendState = &blend;
    info.pDynamicState = &dynamic;
    info.layout = entry.pipeline.layout_;
    VkPipeline handle = VK_NULL_HANDLE;
    VkResult result = VK_SUCCESS;
    if (status)
        result = device_.vk.vkCreateGraphicsPipelines(device_.handle(), VK_NULL_HANDLE, 1, &info, nullptr, &handle);
    for (const auto& stage : stages)
        device_.vk.vkDestroyShaderModule(device_.handle(), stage.module, nullptr);
    SUNFLECK_TRY(status);
    SUNFLECK_VK(result, "creating graphics pipeline '" + d.vertex_shader + "'");
    return handle;
}

Result<VkPipeline> PipelineStore::build(const Entry& entry) {
    return entry.pipeline.bind_point_ == VK_PIPELINE_BIND_POINT_COMPUTE ? build_compute(entry) : build_graphics(entry);
}

Result<const Pipeline*> PipelineStore::finish(std::unique_ptr<Entry> entry) {
    auto handle = build(*entry);
    if (!handle) {
        destroy(*entry);
        return handle.error();
    }
    entry->pipeline.handle_ = *handle;
    const bool compute = entry->pipeline.bind_point_ == VK_PIPELINE_BIND_POINT_COMPUTE;
    const std::string& name = !compute                      ? entry->graphics.vertex_shader
                              : entry->compute.name.empty() ? entry->compute.shader
                                                            : entry->compute.name;
    device_.set_name(VK_OBJECT_TYPE_PIPELINE, std::uint64_t(*handle), name);
    entries_.push_back(std::move(entry));
    return &entries_.back()->pipeline;
}

Result<const Pipeline*> PipelineStore::compute(const ComputeDescription& description) {
    auto entry = std::make_unique<Entry>();
    entry->compute = description;
    SUNFLECK_TRY(make_layout(entry->pipeline, description.bindings, description.push_constant_bytes,
                             VK_SHADER_STAGE_COMPUTE_BIT));
    return finish(std::move(entry));
}

Result<const Pipeline*> PipelineStore::graphics(const GraphicsDescription& description) {
    auto entry = std::make_unique<Entry>();
    entry->graphics = description;
    entry->pipeline.bind_point_ = VK_PIPELINE_BIND_POINT_GRAPHICS;
    SUNFLECK_TRY(make_layout(entry->pipeline, description.bindings, description.push_constant_bytes,
                             VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT));
    return finish(std::move(entry));
}

Status PipelineStore::refresh() {
    std::vector<VkPipeline> fresh;
    for (const auto& entry : entries_) {
        auto handle = build(*entry);
        if (!handle) {
            for (VkPipeline made : fresh)
                device_.vk.vkDestroyPipeline(device_.handle(), made, nullptr);
            return handle.error();
        }
        fresh.push_back(*handle);
    }
    for (std::size_t i = 0; i < entries_.size(); ++i)
        device_.vk.vkDestroyPipeline(device_.handle(), std::exchange(entries_[i]->pipeline.handle_, fresh[i]), nullptr);
    return {};
}

} // namespace sunfleck::gpu

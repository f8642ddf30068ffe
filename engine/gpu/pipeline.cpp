#include "engine/gpu/pipeline.h"

#include <utility>

namespace sunfleck::gpu {

SpecializationValues::SpecializationValues(const std::vector<std::uint32_t>& values) {
    for (std::uint32_t i = 0; i < values.size(); ++i)
        entries.push_back({i, i * 4, 4});
    info = {std::uint32_t(entries.size()), entries.data(), values.size() * 4, values.data()};
}

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

namespace {

Result<ShaderInterface> interface_of(const ShaderLibrary& shaders, const std::string& path, VkShaderStageFlags stage) {
    SUNFLECK_ASSIGN(const auto words, shaders.find(path));
    SUNFLECK_ASSIGN(ShaderInterface interface, reflect(words, path));
    if (interface.stages != stage)
        return Error{"shader '" + path + "' is of another stage than it is used for"};
    return interface;
}

} // namespace

Result<ShaderInterface> PipelineStore::read_interface(const Entry& entry) const {
    if (entry.pipeline.bind_point_ == VK_PIPELINE_BIND_POINT_COMPUTE)
        return interface_of(shaders_, entry.compute.shader, VK_SHADER_STAGE_COMPUTE_BIT);
    SUNFLECK_ASSIGN(ShaderInterface interface,
                    interface_of(shaders_, entry.graphics.vertex_shader, VK_SHADER_STAGE_VERTEX_BIT));
    const std::string& fragment = entry.graphics.fragment_shader;
    if (!fragment.empty()) {
        SUNFLECK_ASSIGN(const ShaderInterface stage, interface_of(shaders_, fragment, VK_SHADER_STAGE_FRAGMENT_BIT));
        SUNFLECK_TRY(merge(interface, stage, fragment));
    }
    return interface;
}

Status PipelineStore::make_layout(Pipeline& pipeline) {
    std::vector<VkDescriptorSetLayoutBinding> set;
    for (const ShaderBinding& binding : pipeline.bindings())
        set.push_back({binding.number, descriptor_type(binding.kind), 1, binding.stages, nullptr});
    VkDescriptorSetLayoutCreateInfo set_info{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
    set_info.bindingCount = std::uint32_t(set.size());
    set_info.pBindings = set.data();
    SUNFLECK_VK(device_.vk.vkCreateDescriptorSetLayout(device_.handle(), &set_info, nullptr, &pipeline.set_layout_),
                "creating a descriptor set layout");
    const VkPushConstantRange range{pipeline.push_stages(), 0, pipeline.push_constant_bytes()};
    VkPipelineLayoutCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
    info.setLayoutCount = 1;
    info.pSetLayouts = &pipeline.set_layout_;
    info.pushConstantRangeCount = range.size > 0 ? 1 : 0;
    info.pPushConstantRanges = &range;
    SUNFLECK_VK(device_.vk.vkCreatePipelineLayout(device_.handle(), &info, nullptr, &pipeline.layout_),
                "creating a pipeline layout");
    return {};
}

Result<VkPipeline> PipelineStore::build_compute(const Entry& entry) {
    SUNFLECK_ASSIGN(const VkShaderModule module, make_module(entry.compute.shader));
    const SpecializationValues specialization(entry.compute.specialization);
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

Result<VkPipeline> PipelineStore::build(const Entry& entry) {
    return entry.pipeline.bind_point_ == VK_PIPELINE_BIND_POINT_COMPUTE ? build_compute(entry) : build_graphics(entry);
}

Result<const Pipeline*> PipelineStore::finish(std::unique_ptr<Entry> entry) {
    SUNFLECK_ASSIGN(entry->pipeline.interface_, read_interface(*entry));
    Status made = make_layout(entry->pipeline);
    auto handle = made ? build(*entry) : Result<VkPipeline>(made.error());
    if (!handle) {
        destroy(*entry);
        return handle.error();
    }
    entry->pipeline.handle_ = *handle;
    const bool named = entry->pipeline.bind_point_ == VK_PIPELINE_BIND_POINT_COMPUTE && !entry->compute.name.empty();
    device_.set_name(VK_OBJECT_TYPE_PIPELINE, std::uint64_t(*handle),
                     named ? entry->compute.name : entry->pipeline.name_);
    entries_.push_back(std::move(entry));
    return &entries_.back()->pipeline;
}

Result<const Pipeline*> PipelineStore::compute(const ComputeDescription& description) {
    for (const auto& entry : entries_)
        if (entry->compute.shader == description.shader && entry->compute.specialization == description.specialization)
            return &entry->pipeline;
    auto entry = std::make_unique<Entry>();
    entry->compute = description;
    entry->pipeline.name_ = description.shader;
    return finish(std::move(entry));
}

Result<const Pipeline*> PipelineStore::graphics(const GraphicsDescription& description) {
    auto entry = std::make_unique<Entry>();
    entry->graphics = description;
    entry->pipeline.bind_point_ = VK_PIPELINE_BIND_POINT_GRAPHICS;
    entry->pipeline.name_ = description.vertex_shader;
    if (!description.fragment_shader.empty())
        entry->pipeline.name_ += "' and '" + description.fragment_shader;
    return finish(std::move(entry));
}

Result<VkPipeline> PipelineStore::rebuild(const Entry& entry) {
    SUNFLECK_ASSIGN(const ShaderInterface interface, read_interface(entry));
    if (interface != entry.pipeline.interface_)
        return Error{"shader '" + entry.pipeline.name_ +
                     "' has other bindings or push constants than before; restart the program to use it"};
    return build(entry);
}

Status PipelineStore::refresh() {
    std::vector<VkPipeline> fresh;
    for (const auto& entry : entries_) {
        auto handle = rebuild(*entry);
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

#include "engine/gpu/pipeline.h"

#include <utility>

namespace sunfleck::gpu {

SpecializationValues::SpecializationValues(const std::vector<std::uint32_t>& values) {
    for (std::uint32_t i = 0; i < values.size(); ++i)
        entries.push_back({i, i * 4, 4});
    info = {std::uint32_t(entries.size()), entries.data(), values.size() * 4, values.data()};
}

ShaderModule::~ShaderModule() {
    if (handle != VK_NULL_HANDLE)
        device->vk.vkDestroyShaderModule(device->handle(), handle, nullptr);
}

Result<ShaderModule> PipelineStore::make_module(const std::string& path) {
    SUNFLECK_ASSIGN(const auto words, shaders_.find(path));
    VkShaderModuleCreateInfo info{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
    info.codeSize = words.size_bytes();
    info.pCode = words.data();
    ShaderModule module(device_);
    SUNFLECK_VK(device_.vk.vkCreateShaderModule(device_.handle(), &info, nullptr, &module.handle),
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

Status PipelineStore::make_layout(BuiltPipeline& built) {
    std::vector<VkDescriptorSetLayoutBinding> set;
    for (const ShaderBinding& binding : built.interface.bindings)
        set.push_back({binding.number, descriptor_type(binding.kind), 1, binding.stages, nullptr});
    VkDescriptorSetLayoutCreateInfo set_info{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
    set_info.bindingCount = std::uint32_t(set.size());
    set_info.pBindings = set.data();
    SUNFLECK_VK(device_.vk.vkCreateDescriptorSetLayout(device_.handle(), &set_info, nullptr, &built.set_layout),
                "creating a descriptor set layout");
    const VkPushConstantRange range{built.interface.push_stages, 0, built.interface.push_constant_bytes};
    VkPipelineLayoutCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
    info.setLayoutCount = 1;
    info.pSetLayouts = &built.set_layout;
    info.pushConstantRangeCount = range.size > 0 ? 1 : 0;
    info.pPushConstantRanges = &range;
    SUNFLECK_VK(device_.vk.vkCreatePipelineLayout(device_.handle(), &info, nullptr, &built.layout),
                "creating a pipeline layout");
    return {};
}

Result<VkPipeline> PipelineStore::build_compute(const Entry& entry, VkPipelineLayout layout) {
    SUNFLECK_ASSIGN(const ShaderModule module, make_module(entry.compute.shader));
    const SpecializationValues specialization(entry.compute.specialization);
    VkComputePipelineCreateInfo info{VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO};
    info.stage = {VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO};
    info.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
    info.stage.module = module.handle;
    info.stage.pName = "main";
    info.stage.pSpecializationInfo = &specialization.info;
    info.layout = layout;
    VkPipeline handle = VK_NULL_HANDLE;
    SUNFLECK_VK(device_.vk.vkCreateComputePipelines(device_.handle(), VK_NULL_HANDLE, 1, &info, nullptr, &handle),
                "creating compute pipeline '" + entry.compute.shader + "'");
    return handle;
}

Result<PipelineKey> PipelineStore::key_of(const Entry& entry) const {
    PipelineKey key{entry.compute, entry.graphics, {}};
    for (const std::string* path :
         {&entry.compute.shader, &entry.graphics.vertex_shader, &entry.graphics.fragment_shader}) {
        if (path->empty())
            continue;
        SUNFLECK_ASSIGN(const auto words, shaders_.find(*path));
        key.add_code(words);
    }
    return key;
}

Result<PipelineStore::Built> PipelineStore::build(const Entry& entry) {
    const auto built = std::make_shared<BuiltPipeline>(device_);
    SUNFLECK_ASSIGN(built->interface, read_interface(entry));
    SUNFLECK_TRY(make_layout(*built));
    const bool compute = entry.pipeline.bind_point_ == VK_PIPELINE_BIND_POINT_COMPUTE;
    SUNFLECK_ASSIGN(built->handle,
                    compute ? build_compute(entry, built->layout) : build_graphics(entry, built->layout));
    device_.set_name(VK_OBJECT_TYPE_PIPELINE, std::uint64_t(built->handle),
                     compute && !entry.compute.name.empty() ? entry.compute.name : entry.pipeline.name_);
    return Built(built);
}

Result<PipelineStore::Built> PipelineStore::obtain(const Entry& entry) {
    SUNFLECK_ASSIGN(const PipelineKey key, key_of(entry));
    if (Built known = device_.pipelines().find(key))
        return known;
    SUNFLECK_ASSIGN(Built built, build(entry));
    return device_.pipelines().keep(key, std::move(built));
}

Result<const Pipeline*> PipelineStore::finish(std::unique_ptr<Entry> entry) {
    SUNFLECK_ASSIGN(entry->pipeline.built_, obtain(*entry));
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
    for (const auto& entry : entries_)
        if (entry->pipeline.bind_point_ == VK_PIPELINE_BIND_POINT_GRAPHICS && entry->graphics == description)
            return &entry->pipeline;
    auto entry = std::make_unique<Entry>();
    entry->graphics = description;
    entry->pipeline.bind_point_ = VK_PIPELINE_BIND_POINT_GRAPHICS;
    entry->pipeline.name_ = description.vertex_shader;
    if (!description.fragment_shader.empty())
        entry->pipeline.name_ += "' and '" + description.fragment_shader;
    return finish(std::move(entry));
}

Result<PipelineStore::Built> PipelineStore::obtain_again(const Entry& entry) {
    SUNFLECK_ASSIGN(const ShaderInterface interface, read_interface(entry));
    if (interface != entry.pipeline.built_->interface)
        return Error{"shader '" + entry.pipeline.name_ +
                     "' has other bindings or push constants than before; restart the program to use it"};
    return obtain(entry);
}

Status PipelineStore::refresh() {
    std::vector<Built> fresh;
    for (const auto& entry : entries_) {
        SUNFLECK_ASSIGN(Built built, obtain_again(*entry));
        fresh.push_back(std::move(built));
    }
    for (std::size_t i = 0; i < entries_.size(); ++i)
        entries_[i]->pipeline.built_ = std::move(fresh[i]);
    device_.pipelines().drop_unused();
    return {};
}

} // namespace sunfleck::gpu

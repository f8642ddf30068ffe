#include "engine/gpu/compute_pass.h"

#include <memory>

namespace sunfleck::gpu {

// What the pass needs when it is recorded.
struct ComputePass::Recording {
    const Pipeline* kernel = nullptr;
    std::vector<Resource> resources;
    std::vector<std::byte> constants;
    std::uint32_t groups[3] = {};
    const Buffer* commands = nullptr; // not null: indirect
    VkDeviceSize offset = 0;

    Status check_access() const;
    Status record(PassContext& context) const;
};

ComputePass::ComputePass(FrameGraph& graph, const std::string& name, const Pipeline& kernel)
    : graph_(graph), pass_(graph.add_pass(name)), kernel_(kernel) {}

ComputePass& ComputePass::uniform(const UploadSlice& slice) {
    resources_.push_back({Binding::uniform(slice), {}, Access::read});
    return *this;
}

ComputePass& ComputePass::storage_read(const UploadSlice& slice) {
    resources_.push_back({Binding::storage(slice), {}, Access::read});
    return *this;
}

ComputePass& ComputePass::sampled(ResourceId image, VkSampler sampler) {
    return add_image(Binding::sampled_image(VK_NULL_HANDLE, sampler), image, Usage::sampled, Access::read);
}

ComputePass& ComputePass::texels(const Buffer& buffer) {
    pass_.read(graph_.import_buffer(buffer), Usage::texel_read);
    resources_.push_back({Binding::texels(buffer), {}, Access::read});
    return *this;
}

ComputePass& ComputePass::storage_read(const BufferRange& range) {
    return add_range(range, Usage::storage_read, Access::read);
}

ComputePass& ComputePass::storage_write(const BufferRange& range) {
    return add_range(range, Usage::storage_write, Access::write);
}

ComputePass& ComputePass::storage_read_write(const BufferRange& range) {
    return add_range(range, Usage::storage_read_write, Access::read_write);
}

ComputePass& ComputePass::storage_read(ResourceId image) {
    return add_image(Binding::storage_image(VK_NULL_HANDLE), image, Usage::storage_read, Access::read);
}

ComputePass& ComputePass::storage_write(ResourceId image) {
    return add_image(Binding::storage_image(VK_NULL_HANDLE), image, Usage::storage_write, Access::write);
}

ComputePass& ComputePass::storage_read_write(ResourceId image) {
    return add_image(Binding::storage_image(VK_NULL_HANDLE), image, Usage::storage_read_write, Access::read_write);
}

ComputePass& ComputePass::constant(const Binding& binding) {
    resources_.push_back({binding, {}, Access::none});
    return *this;
}

ComputePass& ComputePass::add_range(const BufferRange& range, Usage usage, Access access) {
    const ResourceId id = graph_.import_buffer(*range.buffer);
    access == Access::read ? pass_.read(id, usage) : pass_.write(id, usage);
    resources_.push_back({Binding::storage(range), {}, access});
    return *this;
}

ComputePass& ComputePass::add_image(Binding binding, ResourceId image, Usage usage, Access access) {
    access == Access::read ? pass_.read(image, usage) : pass_.write(image, usage);
    resources_.push_back({binding, image, access});
    return *this;
}

void ComputePass::dispatch(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    Recording recording;
    recording.groups[0] = x;
    recording.groups[1] = y;
    recording.groups[2] = z;
    finish(std::move(recording));
}

void ComputePass::dispatch_indirect(const Buffer& commands, VkDeviceSize offset) {
    pass_.read(graph_.import_buffer(commands), Usage::indirect_read);
    Recording recording;
    recording.commands = &commands;
    recording.offset = offset;
    finish(std::move(recording));
}

void ComputePass::finish(Recording recording) {
    recording.kernel = &kernel_;
    recording.resources = std::move(resources_);
    recording.constants = std::move(constants_);
    pass_.execute([shared = std::make_shared<const Recording>(std::move(recording))](PassContext& context) {
        return shared->record(context);
    });
}

// FrameResources::bind checks number and kinds.
Status ComputePass::Recording::check_access() const {
    const auto& declared = kernel->bindings();
    for (std::size_t i = 0; i < std::min(declared.size(), resources.size()); ++i) {
        const Access access = resources[i].access;
        const bool undeclared =
            (declared[i].may_read && access == Access::write) || (declared[i].may_write && access == Access::read);
        if (undeclared)
            return Error{"shader '" + kernel->name() + "' may " + (access == Access::write ? "read" : "write") +
                         " binding " + std::to_string(declared[i].number) + ", which the pass does not say"};
    }
    return {};
}

Status ComputePass::Recording::record(PassContext& context) const {
    SUNFLECK_TRY(check_access());
    std::vector<Binding> bindings;
    for (const Resource& resource : resources) {
        bindings.push_back(resource.binding);
        if (resource.image.valid())
            bindings.back().image_info.imageView = context.graph.view(resource.image);
    }
    SUNFLECK_TRY(context.resources.bind(context.commands, *kernel, bindings));
    if (!constants.empty() || kernel->push_constant_bytes() > 0)
        SUNFLECK_TRY(context.resources.push_bytes(context.commands, *kernel, constants));
    const DeviceFunctions& vk = context.device.vk;
    if (commands != nullptr)
        vk.vkCmdDispatchIndirect(context.commands, commands->handle(), offset);
    else
        vk.vkCmdDispatch(context.commands, groups[0], groups[1], groups[2]);
    return {};
}

} // namespace sunfleck::gpu

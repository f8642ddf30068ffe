#include "engine/gpu/frame_graph.h"

#include "engine/gpu/debug_label.h"
#ifdef SUNFLECK_SLOW_WORK
#include "engine/gpu/slow_work.h"
#endif

#include <algorithm>
#include <cassert>
#include <sstream>
#include <utility>
#include <vulkan/vk_enum_string_helper.h>

namespace sunfleck::gpu {
namespace {

// How the host uses an image after the graph.
UsageTraits exit_traits(const ImportedImage& image) {
    if (image.exit != Usage::host)
        return traits_of(image.exit);
    return {"host", image.exit_stages, image.exit_access, image.exit_layout, 0};
}

} // namespace

FrameGraph::PassBuilder& FrameGraph::PassBuilder::read(ResourceId id, Usage usage) {
    graph_.passes_[index_].accesses.push_back({id, usage, false});
    return *this;
}

FrameGraph::PassBuilder& FrameGraph::PassBuilder::write(ResourceId id, Usage usage) {
    graph_.passes_[index_].accesses.push_back({id, usage, true});
    return *this;
}

FrameGraph::PassBuilder& FrameGraph::PassBuilder::keep() {
    graph_.passes_[index_].kept = true;
    return *this;
}

FrameGraph::PassBuilder& FrameGraph::PassBuilder::execute(Execute execute) {
    graph_.passes_[index_].execute = std::move(execute);
    return *this;
}

void FrameGraph::reset() {
    resources_.clear();
    passes_.clear();
    compiled_.clear();
    exit_ = {};
    when_executed_.clear();
}

ResourceId FrameGraph::add_resource(Resource resource) {
    resources_.push_back(std::move(resource));
    return {std::uint32_t(resources_.size() - 1)};
}

ResourceId FrameGraph::import_buffer(const Buffer& buffer) {
    for (std::uint32_t i = 0; i < resources_.size(); ++i)
        if (resources_[i].buffer == &buffer)
            return {i};
    Resource resource;
    resource.name = buffer.name();
    resource.external = resource.output = resource.written = true;
    resource.buffer = &buffer;
    resource.state = buffer.state();
    return add_resource(std::move(resource));
}

ResourceId FrameGraph::import_image(const Image& image) {
    for (std::uint32_t i = 0; i < resources_.size(); ++i)
        if (resources_[i].image == &image)
            return {i};
    Resource resource;
    resource.name = image.description().name;
    resource.is_image = resource.external = resource.output = resource.written = true;
    resource.image = &image;
    resource.description = image.description();
    resource.state = image.state();
    return add_resource(std::move(resource));
}

ResourceId FrameGraph::import_host_image(const ImportedImage& image) {
    Resource resource;
    resource.name = image.name;
    resource.is_image = resource.external = resource.output = resource.written = true;
    resource.host_image = image.image;
    resource.host_view = image.view;
    resource.description = image.description;
    resource.state = image.entry;
    resource.has_exit = image.has_exit;
    resource.host = image;
    return add_resource(std::move(resource));
}

ResourceId FrameGraph::create_virtual(const std::string& name) {
    Resource resource;
    resource.name = name;
    return add_resource(std::move(resource));
}

ResourceId FrameGraph::create_image(const std::string& name, VkFormat format, std::uint32_t width, std::uint32_t height,
                                    std::uint32_t layers, std::uint32_t samples) {
    Resource resource;
    resource.name = name;
    resource.is_image = resource.created = true;
    resource.description = {name, format, width, height, layers, 1, 0, layers > 1, samples};
    // Images of one name in one frame (two lightings of a scene, say) are distinguished by their order.
    const auto same = std::count_if(resources_.begin(), resources_.end(),
                                    [&](const Resource& other) { return other.created && other.name == name; });
    resource.pool_key = same == 0 ? name : name + " " + std::to_string(same + 1);
    return add_resource(std::move(resource));
}

FrameGraph::History FrameGraph::create_history(const std::string& name, VkFormat format, std::uint32_t width,
                                               std::uint32_t height) {
    HistoryEntry& entry = histories_[name];
    History history;
    history.previous_valid = entry.turn > 0 && entry.format == format && entry.width == width && entry.height == height;
    if (!history.previous_valid)
        entry = {0, format, width, height};
    const std::uint32_t parity = entry.turn++ & 1u;
    history.current = create_image(name, format, width, height);
    history.previous = create_image(name, format, width, height);
    resources_[history.current.index].pool_key = name + (parity ? " odd" : " even");
    resources_[history.current.index].output = true; // the next frame reads it
    Resource& previous = resources_[history.previous.index];
    previous.pool_key = name + (parity ? " even" : " odd");
    previous.written = history.previous_valid;
    if (const auto found = pool_.find(previous.pool_key); history.previous_valid && found != pool_.end())
        previous.state = found->second.state();
    return history;
}

void FrameGraph::mark_output(ResourceId id) {
    resources_[id.index].output = true;
}

FrameGraph::PassBuilder FrameGraph::add_pass(const std::string& name) {
    passes_.push_back({});
    passes_.back().name = name;
    return PassBuilder(*this, std::uint32_t(passes_.size() - 1));
}

void FrameGraph::add_full_barrier() {
    add_pass("full barrier").keep().execute([](PassContext& context) -> Status {
        VkMemoryBarrier2 memory{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
        memory.srcStageMask = memory.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
        memory.srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT;
        memory.dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
        VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
        info.memoryBarrierCount = 1;
        info.pMemoryBarriers = &memory;
        context.device.vk.vkCmdPipelineBarrier2(context.commands, &info);
        return {};
    });
}

void FrameGraph::when_executed(std::function<void()> callback) {
    when_executed_.push_back(std::move(callback));
}

// Backwards: a pass lives if it is kept, or writes something that is an output or that a later living pass reads.
void FrameGraph::cull() {
    std::vector<bool> needed(resources_.size());
    for (std::size_t i = 0; i < resources_.size(); ++i)
        needed[i] = resources_[i].output;
    for (auto pass = passes_.rbegin(); pass != passes_.rend(); ++pass) {
        pass->live = pass->kept || std::any_of(pass->accesses.begin(), pass->accesses.end(), [&](const Access& access) {
                         return access.write && needed[access.id.index];
                     });
        if (!pass->live)
            continue;
        for (const Access& access : pass->accesses)
            if (!access.write || access.usage == Usage::storage_read_write)
                needed[access.id.index] = true;
    }
}

Status FrameGraph::derive_barriers(const Pass& pass, CompiledPass& compiled) {
    for (const Access& access : pass.accesses) {
        Resource& resource = resources_[access.id.index];
        if (!access.write && !resource.written)
            return Error{"frame graph: pass '" + pass.name + "' reads '" + resource.name +
                         "', which nothing has written"};
        PassBarrier barrier;
        if (advance(resource.state, traits_of(access.usage), access.write, resource.is_image, barrier)) {
            barrier.resource = resource.name;
            barrier.resource_index = access.id.index;
            barrier.is_image = resource.is_image;
            compiled.barriers.push_back(barrier);
        }
        resource.written = resource.written || access.write;
        if (resource.created)
            resource.description.usage |= traits_of(access.usage).image_usage;
    }
    return {};
}

// Created images keep the state that their last frame left, so that frames in flight do not overlap on them; their
// content is not kept.
void FrameGraph::restore_states() {
    for (Resource& resource : resources_)
        if (const auto found = pool_.find(resource.pool_key); resource.created && found != pool_.end()) {
            const bool keep_content = resource.written;
            resource.state = found->second.state();
            if (!keep_content)
                resource.state.layout = VK_IMAGE_LAYOUT_UNDEFINED;
        }
}

void FrameGraph::derive_exit_barriers() {
    constexpr VkAccessFlags2 writes =
        VK_ACCESS_2_SHADER_WRITE_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT |
        VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
    exit_ = {};
    exit_.name = "exit";
    for (std::uint32_t i = 0; i < resources_.size(); ++i) {
        PassBarrier barrier;
        Resource& resource = resources_[i];
        const UsageTraits exit = exit_traits(resource.host);
        if (!resource.has_exit || !advance(resource.state, exit, (exit.access & writes) != 0, true, barrier))
            continue;
        barrier.resource = resource.name;
        barrier.resource_index = i;
        barrier.is_image = true;
        exit_.barriers.push_back(barrier);
    }
}

Status FrameGraph::compile() {
    compiled_.clear();
    cull();
    restore_states();
    for (std::uint32_t i = 0; i < passes_.size(); ++i) {
        if (!passes_[i].live)
            continue;
        CompiledPass compiled;
        compiled.name = passes_[i].name;
        compiled.pass_index = i;
        SUNFLECK_TRY(derive_barriers(passes_[i], compiled));
        compiled_.push_back(std::move(compiled));
    }
    derive_exit_barriers();
    return {};
}

Status FrameGraph::realise_images(FrameResources& resources) {
    for (Resource& resource : resources_) {
        if (!resource.created || resource.description.usage == 0)
            continue;
        Image& image = pool_[resource.pool_key];
        const ImageDescription& has = image.description();
        const bool fits = image && has.format == resource.description.format &&
                          has.width == resource.description.width && has.height == resource.description.height &&
                          has.layers == resource.description.layers && has.samples == resource.description.samples &&
                          (has.usage & resource.description.usage) == resource.description.usage;
        if (!fits) {
            // Rare (first use, resize): frames in flight may still use the old image.
            resource.description.usage |= image ? has.usage : 0;
            if (image)
                resources.retire(std::move(image));
            SUNFLECK_ASSIGN(image, Image::create(*device_, resource.description));
        }
        resource.image = &image;
    }
    return {};
}

void FrameGraph::record_barriers(VkCommandBuffer commands, const std::vector<PassBarrier>& barriers) const {
    VkMemoryBarrier2 memory{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
    std::vector<VkImageMemoryBarrier2> images;
    for (const PassBarrier& barrier : barriers) {
        if (!barrier.is_image) { // buffers share one memory barrier
            memory.srcStageMask |= barrier.source_stages;
            memory.srcAccessMask |= barrier.source_access;
            memory.dstStageMask |= barrier.destination_stages;
            memory.dstAccessMask |= barrier.destination_access;
            continue;
        }
        const Resource& resource = resources_[barrier.resource_index];
        VkImageMemoryBarrier2 image{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2};
        image.srcStageMask = barrier.source_stages;
        image.srcAccessMask = barrier.source_access;
        image.dstStageMask = barrier.destination_stages;
        image.dstAccessMask = barrier.destination_access;
        image.oldLayout = barrier.old_layout;
        image.newLayout = barrier.new_layout;
        image.srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
        image.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
        image.image = resource.image != nullptr ? resource.image->handle() : resource.host_image;
        image.subresourceRange = {Image::aspect_of(resource.description.format), 0, VK_REMAINING_MIP_LEVELS, 0,
                                  VK_REMAINING_ARRAY_LAYERS};
        images.push_back(image);
    }
    VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
    info.memoryBarrierCount = memory.dstStageMask != 0 ? 1 : 0;
    info.pMemoryBarriers = &memory;
    info.imageMemoryBarrierCount = std::uint32_t(images.size());
    info.pImageMemoryBarriers = images.data();
    if (info.memoryBarrierCount + info.imageMemoryBarrierCount > 0)
        device_->vk.vkCmdPipelineBarrier2(commands, &info);
}

Status FrameGraph::record_pass(PassContext& context, const CompiledPass& compiled, Timers* timers) {
    const DebugLabel label(*device_, context.commands, compiled.name);
    const TimerScope timer(timers, context.commands, compiled.name);
    record_barriers(context.commands, compiled.barriers);
    const Pass& pass = passes_[compiled.pass_index];
#ifdef SUNFLECK_SLOW_WORK
    // Before the pass: a software rasteriser would wait for its triangles before a dispatch after it.
    SUNFLECK_TRY(add_slow_work(context, compiled.name));
#endif
    const Status status = pass.execute ? pass.execute(context) : Status();
    if (progress_ != nullptr)
        progress_->pass_recorded(context.commands);
    return status ? status : Error{"pass '" + pass.name + "': " + status.error().message, status.error().code};
}

Status FrameGraph::execute(VkCommandBuffer commands, FrameResources& resources, Timers* timers) {
    assert(device_ != nullptr && "a graph without a device cannot execute");
    SUNFLECK_TRY(realise_images(resources));
    PassContext context{*device_, commands, resources, *this};
    for (const CompiledPass& compiled : compiled_)
        SUNFLECK_TRY(record_pass(context, compiled, timers));
    record_barriers(commands, exit_.barriers);
    store_states();
    for (const auto& callback : std::exchange(when_executed_, {}))
        callback();
    return {};
}

void FrameGraph::store_states() {
    for (const Resource& resource : resources_) {
        if (resource.buffer != nullptr)
            resource.buffer->state() = resource.state;
        if (resource.image != nullptr)
            resource.image->state() = resource.state;
    }
}

std::vector<std::string> FrameGraph::culled() const {
    std::vector<std::string> names;
    for (const Pass& pass : passes_)
        if (!pass.live)
            names.push_back(pass.name);
    return names;
}

std::string FrameGraph::print() const {
    std::ostringstream text;
    for (const CompiledPass& compiled : compiled_) {
        text << compiled.name << '\n';
        for (const PassBarrier& barrier : compiled.barriers) {
            text << "  barrier " << barrier.resource;
            if (barrier.is_image)
                text << ": " << string_VkImageLayout(barrier.old_layout) << " -> "
                     << string_VkImageLayout(barrier.new_layout);
            text << '\n';
        }
        for (const Access& access : passes_[compiled.pass_index].accesses)
            text << (access.write ? "  writes " : "  reads  ") << resources_[access.id.index].name << " ("
                 << traits_of(access.usage).name << ")\n";
    }
    for (const std::string& name : culled())
        text << "culled " << name << '\n';
    return text.str();
}

VkImageView FrameGraph::view(ResourceId id) const {
    const Resource& resource = resources_[id.index];
    return resource.image != nullptr ? resource.image->view() : resource.host_view;
}

VkImage FrameGraph::image(ResourceId id) const {
    const Resource& resource = resources_[id.index];
    return resource.image != nullptr ? resource.image->handle() : resource.host_image;
}

} // namespace sunfleck::gpu

#include "engine/gpu/frame_resources.h"

#include <algorithm>

namespace sunfleck::gpu {
namespace {
constexpr VkDeviceSize upload_block_size = VkDeviceSize(1) << 20;
constexpr std::uint32_t sets_per_pool = 256;
constexpr std::uint64_t frames_kept = 120; // after their last use, blocks of upload memory are destroyed
} // namespace

FrameResources::~FrameResources() {
    for (const auto* pools : {&active_pools_, &spare_pools_})
        for (const Pool& pool : *pools)
            device_.vk.vkDestroyDescriptorPool(device_.handle(), pool.handle, nullptr);
}

void FrameResources::begin_frame(std::uint64_t serial, std::uint64_t completed_serial) {
    if (serial < serial_)
        belong_to(serial);
    serial_ = serial;
    const auto recycle = [&](auto& active, auto& spare) {
        const auto done = std::stable_partition(active.begin(), active.end(),
                                                [&](const auto& entry) { return entry.serial > completed_serial; });
        spare.insert(spare.end(), std::make_move_iterator(done), std::make_move_iterator(active.end()));
        active.erase(done, active.end());
    };
    recycle(active_blocks_, spare_blocks_);
    std::erase_if(spare_blocks_, [&](const Block& block) { return block.serial + frames_kept < serial; });
    recycle(active_pools_, spare_pools_);
    while (!retired_.empty() && retired_.front().first <= completed_serial)
        retired_.pop_front();
}

// Frames of greater serials were begun, but never submitted: the GPU is done with what they used, or retired, when it
// is done with this one.
void FrameResources::belong_to(std::uint64_t serial) {
    const auto lower = [&](std::uint64_t& of) { of = std::min(of, serial); };
    for (auto* blocks : {&active_blocks_, &spare_blocks_})
        for (Block& block : *blocks)
            lower(block.serial);
    for (Pool& pool : active_pools_)
        lower(pool.serial);
    for (auto& entry : retired_)
        lower(entry.first);
}

Result<UploadSlice> FrameResources::allocate(VkDeviceSize size) {
    const VkDeviceSize alignment = std::max<VkDeviceSize>(
        {device_.traits().uniform_alignment, device_.traits().storage_alignment, VkDeviceSize(64)});
    const VkDeviceSize rounded = std::max<VkDeviceSize>((size + alignment - 1) / alignment * alignment, alignment);
    const bool fits = !active_blocks_.empty() && active_blocks_.back().serial == serial_ &&
                      active_blocks_.back().used + rounded <= active_blocks_.back().buffer.size();
    if (!fits) {
        // The smallest that will do, since a large one that a small request took would be missed by the next large one;
        // of equal ones that which was used last, so that those too many are left alone and go.
        auto spare = spare_blocks_.end();
        for (auto block = spare_blocks_.begin(); block != spare_blocks_.end(); ++block)
            if (block->buffer.size() >= rounded &&
                (spare == spare_blocks_.end() || block->buffer.size() < spare->buffer.size() ||
                 (block->buffer.size() == spare->buffer.size() && block->serial >= spare->serial)))
                spare = block;
        if (spare != spare_blocks_.end()) {
            active_blocks_.push_back(std::move(*spare));
            spare_blocks_.erase(spare);
        } else {
            BufferDescription description;
            description.name = "frame uploads";
            // In whole blocks, so that a request that grows from frame to frame takes the same one.
            description.size = (rounded + upload_block_size - 1) / upload_block_size * upload_block_size;
            description.usage = VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT |
                                VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT |
                                VK_BUFFER_USAGE_VERTEX_BUFFER_BIT;
            description.memory = MemoryUse::upload;
            SUNFLECK_ASSIGN(Buffer buffer, Buffer::create(device_, description));
            active_blocks_.push_back({std::move(buffer), 0, serial_});
        }
        active_blocks_.back().used = 0;
        active_blocks_.back().serial = serial_;
    }
    Block& block = active_blocks_.back();
    const UploadSlice slice{block.buffer.handle(), block.used, std::max<VkDeviceSize>(size, 16),
                            block.buffer.mapped() + block.used};
    block.used += rounded;
    return slice;
}

Status FrameResources::next_pool() {
    if (!spare_pools_.empty()) {
        active_pools_.push_back(spare_pools_.back());
        spare_pools_.pop_back();
        active_pools_.back().serial = serial_;
        SUNFLECK_VK(device_.vk.vkResetDescriptorPool(device_.handle(), active_pools_.back().handle, 0),
                    "resetting a descriptor pool");
        return {};
    }
    const VkDescriptorPoolSize sizes[] = {
        {VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, sets_per_pool * 2},
        {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, sets_per_pool * 4},
        {VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER, sets_per_pool},
        {VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, sets_per_pool * 2},
        {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, sets_per_pool * 6},
    };
    VkDescriptorPoolCreateInfo info{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
    info.maxSets = sets_per_pool;
    info.poolSizeCount = std::uint32_t(std::size(sizes));
    info.pPoolSizes = sizes;
    Pool pool;
    pool.serial = serial_;
    active_pools_.reserve(active_pools_.size() + 1); // what is made must find its place
    SUNFLECK_VK(device_.vk.vkCreateDescriptorPool(device_.handle(), &info, nullptr, &pool.handle),
                "creating a descriptor pool");
    active_pools_.push_back(pool);
    return {};
}

Result<VkDescriptorSet> FrameResources::allocate_set(const Pipeline& pipeline) {
    const VkDescriptorSetLayout layout = pipeline.set_layout();
    for (int attempt = 0; attempt < 2; ++attempt) {
        if (attempt == 1 || active_pools_.empty() || active_pools_.back().serial != serial_)
            SUNFLECK_TRY(next_pool());
        VkDescriptorSetAllocateInfo info{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
        info.descriptorPool = active_pools_.back().handle;
        info.descriptorSetCount = 1;
        info.pSetLayouts = &layout;
        VkDescriptorSet set = VK_NULL_HANDLE;
        const VkResult result = device_.vk.vkAllocateDescriptorSets(device_.handle(), &info, &set);
        if (result == VK_SUCCESS)
            return set;
        if (result != VK_ERROR_OUT_OF_POOL_MEMORY && result != VK_ERROR_FRAGMENTED_POOL)
            return vulkan_error(result, "allocating a descriptor set");
    }
    return Error{"a descriptor set does not fit an empty pool"};
}

namespace {

Status check_bindings(const Pipeline& pipeline, std::span<const Binding> bindings, std::uint64_t most_bytes) {
    const auto& declared = pipeline.bindings();
    if (bindings.size() != declared.size())
        return Error{"shader '" + pipeline.name() + "' declares " + std::to_string(declared.size()) +
                     " bindings, but " + std::to_string(bindings.size()) + " are bound"};
    for (std::size_t i = 0; i < declared.size(); ++i)
        if (bindings[i].kind != declared[i].kind)
            return Error{"shader '" + pipeline.name() + "' declares binding " + std::to_string(declared[i].number) +
                         " as a " + name_of(declared[i].kind) + ", but a " + name_of(bindings[i].kind) + " is bound"};
    for (std::size_t i = 0; i < declared.size(); ++i)
        if (bindings[i].kind == BindingKind::storage_buffer && bindings[i].buffer_info.range > most_bytes)
            return Error{"shader '" + pipeline.name() + "' needs " + std::to_string(bindings[i].buffer_info.range) +
                             " bytes in binding " + std::to_string(declared[i].number) + ", and this device allows " +
                             std::to_string(most_bytes) +
                             ": a smaller picture or level, or fewer light samples, need less",
                         ErrorCode::unsupported};
    return {};
}

} // namespace

Status FrameResources::bind(VkCommandBuffer commands, const Pipeline& pipeline, std::span<const Binding> bindings) {
    SUNFLECK_TRY(check_bindings(pipeline, bindings, device_.traits().max_storage_range));
    device_.vk.vkCmdBindPipeline(commands, pipeline.bind_point(), pipeline.handle());
    if (bindings.empty())
        return {};
    SUNFLECK_ASSIGN(const VkDescriptorSet set, allocate_set(pipeline));
    std::vector<VkWriteDescriptorSet> writes;
    for (std::size_t i = 0; i < bindings.size(); ++i) {
        VkWriteDescriptorSet write{VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
        write.dstSet = set;
        write.dstBinding = pipeline.bindings()[i].number;
        write.descriptorCount = 1;
        write.descriptorType = descriptor_type(bindings[i].kind);
        write.pBufferInfo = &bindings[i].buffer_info;
        write.pImageInfo = &bindings[i].image_info;
        write.pTexelBufferView = &bindings[i].texel_view;
        writes.push_back(write);
    }
    device_.vk.vkUpdateDescriptorSets(device_.handle(), std::uint32_t(writes.size()), writes.data(), 0, nullptr);
    device_.vk.vkCmdBindDescriptorSets(commands, pipeline.bind_point(), pipeline.layout(), 0, 1, &set, 0, nullptr);
    return {};
}

Status FrameResources::push_bytes(VkCommandBuffer commands, const Pipeline& pipeline,
                                  std::span<const std::byte> constants) {
    constexpr std::size_t most_padding = 12; // up to the next vec4
    const std::uint32_t declared = pipeline.push_constant_bytes();
    if (declared == 0 || constants.size() < declared || constants.size() > declared + most_padding)
        return Error{"shader '" + pipeline.name() + "' declares " + std::to_string(declared) +
                     " bytes of push constants, but " + std::to_string(constants.size()) + " are pushed"};
    device_.vk.vkCmdPushConstants(commands, pipeline.layout(), pipeline.push_stages(), 0, declared, constants.data());
    return {};
}

} // namespace sunfleck::gpu

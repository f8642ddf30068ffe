#include "engine/gpu/frame_resources.h"

#include <algorithm>
#include <cassert>

namespace sunfleck::gpu {
namespace {
constexpr VkDeviceSize upload_block_size = VkDeviceSize(1) << 20;
constexpr std::uint32_t sets_per_pool = 256;
} // namespace

FrameResources::~FrameResources() {
    for (const auto* pools : {&active_pools_, &spare_pools_})
        for (const Pool& pool : *pools)
            device_.vk.vkDestroyDescriptorPool(device_.handle(), pool.handle, nullptr);
}

void FrameResources::begin_frame(std::uint64_t serial, std::uint64_t completed_serial) {
    serial_ = serial;
    const auto recycle = [&](auto& active, auto& spare) {
        const auto done = std::stable_partition(active.begin(), active.end(),
                                                [&](const auto& entry) { return entry.serial > completed_serial; });
        spare.insert(spare.end(), std::make_move_iterator(done), std::make_move_iterator(active.end()));
        active.erase(done, active.end());
    };
    recycle(active_blocks_, spare_blocks_);
    recycle(active_pools_, spare_pools_);
    while (!retired_.empty() && retired_.front().first <= completed_serial)
        retired_.pop_front();
}

Result<UploadSlice> FrameResources::allocate(VkDeviceSize size) {
    const VkDeviceSize alignment = std::max<VkDeviceSize>(
        {device_.traits().uniform_alignment, device_.traits().storage_alignment, VkDeviceSize(64)});
    const VkDeviceSize rounded = std::max<VkDeviceSize>((size + alignment - 1) / alignment * alignment, alignment);
    const bool fits = !active_blocks_.empty() && active_blocks_.back().serial == serial_ &&
                      active_blocks_.back().used + rounded <= active_blocks_.back().buffer.size();
    if (!fits) {
        const auto spare = std::find_if(spare_blocks_.begin(), spare_blocks_.end(),
                                        [&](const Block& block) { return block.buffer.size() >= rounded; });
        if (spare != spare_blocks_.end()) {
            active_blocks_.push_back(std::move(*spare));
            spare_blocks_.erase(spare);
        } else {
            BufferDescription description;
            description.name = "frame uploads";
            description.size = std::max(rounded, upload_block_size);
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

Status FrameResources::bind(VkCommandBuffer commands, const Pipeline& pipeline, std::span<const Binding> bindings) {
    assert(bindings.size() == pipeline.bindings().size() && "one entry for each binding of the pipeline");
    device_.vk.vkCmdBindPipeline(commands, pipeline.bind_point(), pipeline.handle());
    if (bindings.empty())
        return {};
    SUNFLECK_ASSIGN(const VkDescriptorSet set, allocate_set(pipeline));
    std::vector<VkWriteDescriptorSet> writes;
    for (std::uint32_t i = 0; i < bindings.size(); ++i) {
        VkWriteDescriptorSet write{VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
        write.dstSet = set;
        write.dstBinding = i;
        write.descriptorCount = 1;
        write.pBufferInfo = &bindings[i].buffer_info;
        write.pImageInfo = &bindings[i].image_info;
        write.pTexelBufferView = &bindings[i].texel_view;
        switch (pipeline.bindings()[i]) {
        case BindingKind::uniform_buffer:
            write.descriptorType = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
            break;
        case BindingKind::storage_buffer:
            write.descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
            break;
        case BindingKind::texel_buffer:
            write.descriptorType = VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER;
            break;
        case BindingKind::storage_image:
            write.descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_IMAGE;
            break;
        case BindingKind::sampled_image:
            write.descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
            break;
        }
        writes.push_back(write);
    }
    device_.vk.vkUpdateDescriptorSets(device_.handle(), std::uint32_t(writes.size()), writes.data(), 0, nullptr);
    device_.vk.vkCmdBindDescriptorSets(commands, pipeline.bind_point(), pipeline.layout(), 0, 1, &set, 0, nullptr);
    return {};
}

} // namespace sunfleck::gpu

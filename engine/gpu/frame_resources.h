// What one frame needs and gives back when the GPU has finished it: upload memory, descriptor sets, retired resources.
#pragma once

#include "engine/gpu/pipeline.h"
#include "engine/gpu/resources.h"

#include <any>
#include <cstring>
#include <deque>
#include <span>

namespace sunfleck::gpu {

// A piece of upload memory, valid until its frame is complete on the GPU.
struct UploadSlice {
    VkBuffer buffer = VK_NULL_HANDLE;
    VkDeviceSize offset = 0;
    VkDeviceSize size = 0;
    std::byte* data = nullptr;
};

// What is bound at one binding of a pipeline.
struct Binding {
    static Binding buffer(const Buffer& buffer) { return {{buffer.handle(), 0, VK_WHOLE_SIZE}, {}, {}}; }
    static Binding slice(const UploadSlice& slice) { return {{slice.buffer, slice.offset, slice.size}, {}, {}}; }
    static Binding range(const Buffer& buffer, VkDeviceSize offset, VkDeviceSize size) {
        return {{buffer.handle(), offset, size}, {}, {}};
    }
    static Binding texels(const Buffer& buffer) { return {{}, {}, buffer.texel_view()}; }
    static Binding storage_image(VkImageView view) { return {{}, {VK_NULL_HANDLE, view, VK_IMAGE_LAYOUT_GENERAL}, {}}; }
    static Binding sampled_image(VkImageView view, VkSampler sampler) {
        return {{}, {sampler, view, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL}, {}};
    }

    VkDescriptorBufferInfo buffer_info{};
    VkDescriptorImageInfo image_info{};
    VkBufferView texel_view = VK_NULL_HANDLE;
};

class FrameResources {
public:
    explicit FrameResources(Device& device) : device_(device) {}
    ~FrameResources();
    FrameResources(const FrameResources&) = delete;
    FrameResources& operator=(const FrameResources&) = delete;

    // Starts the frame `serial`; whatever belongs to frames up to `completed_serial` is reused or destroyed.
    void begin_frame(std::uint64_t serial, std::uint64_t completed_serial);

    Result<UploadSlice> allocate(VkDeviceSize size);
    template <typename T>
    Result<UploadSlice> upload(std::span<const T> values) {
        SUNFLECK_ASSIGN(const UploadSlice slice, allocate(values.size_bytes()));
        if (!values.empty())
            std::memcpy(slice.data, values.data(), values.size_bytes());
        return slice;
    }
    template <typename T>
    Result<UploadSlice> upload_value(const T& value) {
        return upload(std::span<const T>(&value, 1));
    }

    // Binds `pipeline` with one entry per binding, in order.
    Status bind(VkCommandBuffer commands, const Pipeline& pipeline, std::span<const Binding> bindings);
    template <typename T>
    void push(VkCommandBuffer commands, const Pipeline& pipeline, const T& constants) {
        device_.vk.vkCmdPushConstants(commands, pipeline.layout(), pipeline.push_stages(), 0, sizeof(T), &constants);
    }

    // Keeps `object` (a shared_ptr to a Buffer or Image, say) until the current frame is complete on the GPU.
    template <typename T>
    void retire(T&& object) {
        retired_.push_back({serial_, std::make_shared<T>(std::move(object))});
    }

private:
    struct Block {
        Buffer buffer;
        VkDeviceSize used = 0;
        std::uint64_t serial = 0;
    };
    struct Pool {
        VkDescriptorPool handle = VK_NULL_HANDLE;
        std::uint64_t serial = 0;
    };
    Result<VkDescriptorSet> allocate_set(const Pipeline& pipeline);
    Status next_pool();

    Device& device_;
    std::uint64_t serial_ = 0;
    std::vector<Block> active_blocks_, spare_blocks_;
    std::vector<Pool> active_pools_, spare_pools_;
    std::deque<std::pair<std::uint64_t, std::any>> retired_;
};

} // namespace sunfleck::gpu

// What one frame needs and gives back when the GPU has finished it: upload memory, descriptor sets, retired resources.
#pragma once

#include "engine/gpu/pipeline.h"
#include "engine/gpu/resources.h"

#include <any>
#include <cstring>
#include <deque>
#include <optional>
#include <span>

namespace sunfleck::gpu {

// A piece of upload memory, valid until its frame is complete on the GPU.
struct UploadSlice {
    VkBuffer buffer = VK_NULL_HANDLE;
    VkDeviceSize offset = 0;
    VkDeviceSize size = 0;
    std::byte* data = nullptr;
};

// A buffer, or a part of it.
struct BufferRange {
    BufferRange(const Buffer& whole) : buffer(&whole) {}
    BufferRange(const Buffer& whole, VkDeviceSize first, VkDeviceSize bytes)
        : buffer(&whole), offset(first), size(bytes) {}
    const Buffer* buffer;
    VkDeviceSize offset = 0, size = VK_WHOLE_SIZE;
};

// What is bound at one binding of a pipeline.
struct Binding {
    static Binding uniform(const UploadSlice& slice) { return of_slice(BindingKind::uniform_buffer, slice); }
    static Binding storage(const UploadSlice& slice) { return of_slice(BindingKind::storage_buffer, slice); }
    static Binding storage(const BufferRange& range) {
        Binding binding{BindingKind::storage_buffer};
        const VkDeviceSize rest = range.buffer->size() - range.offset;
        binding.buffer_info = {range.buffer->handle(), range.offset, range.size == VK_WHOLE_SIZE ? rest : range.size};
        return binding;
    }
    static Binding texels(const Buffer& buffer) {
        Binding binding{BindingKind::texel_buffer};
        binding.texel_view = buffer.texel_view();
        return binding;
    }
    static Binding storage_image(VkImageView view) {
        Binding binding{BindingKind::storage_image};
        binding.image_info = {VK_NULL_HANDLE, view, VK_IMAGE_LAYOUT_GENERAL};
        return binding;
    }
    static Binding sampled_image(VkImageView view, VkSampler sampler) {
        Binding binding{BindingKind::sampled_image};
        binding.image_info = {sampler, view, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
        return binding;
    }

    BindingKind kind{};
    VkDescriptorBufferInfo buffer_info{};
    VkDescriptorImageInfo image_info{};
    VkBufferView texel_view = VK_NULL_HANDLE;

private:
    static Binding of_slice(BindingKind kind, const UploadSlice& slice) {
        Binding binding{kind};
        binding.buffer_info = {slice.buffer, slice.offset, slice.size};
        return binding;
    }
    explicit Binding(BindingKind what) : kind(what) {}
};

class FrameResources {
public:
    explicit FrameResources(Device& device) : device_(device) {}
    ~FrameResources();
    FrameResources(const FrameResources&) = delete;
    FrameResources& operator=(const FrameResources&) = delete;

    // Starts the frame `serial`; whatever belongs to frames up to `completed_serial` is reused or destroyed. A lesser
    // serial than before says that those from it on were never submitted.
    void begin_frame(std::uint64_t serial, std::uint64_t completed_serial);
    std::uint64_t serial() const { return serial_; }

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

    // Binds `pipeline` with one entry for each of its bindings, by ascending binding number. An error if their number
    // or kinds are not what the shaders declare, and one (ErrorCode::unsupported) if a storage buffer is larger than
    // the device lets a shader see.
    Status bind(VkCommandBuffer commands, const Pipeline& pipeline, std::span<const Binding> bindings);
    // All of the pipeline's push constants. Bytes after those that the shaders declare are padding, and left out.
    Status push_bytes(VkCommandBuffer commands, const Pipeline& pipeline, std::span<const std::byte> constants);
    template <typename T>
    Status push(VkCommandBuffer commands, const Pipeline& pipeline, const T& constants) {
        return push_bytes(commands, pipeline, std::as_bytes(std::span<const T>(&constants, 1)));
    }

    // Keeps `object` (a shared_ptr to a Buffer or Image, say) until the current frame is complete on the GPU. Where
    // memory runs out, it stays the caller's, since frames in flight may use it.
    template <typename T>
    void retire(T&& object) {
        auto kept = std::make_shared<std::optional<std::decay_t<T>>>();
        retired_.emplace_back(serial_, kept);
        kept->emplace(std::forward<T>(object));
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
    void belong_to(std::uint64_t serial);

    Device& device_;
    std::uint64_t serial_ = 0;
    std::vector<Block> active_blocks_, spare_blocks_;
    std::vector<Pool> active_pools_, spare_pools_;
    std::deque<std::pair<std::uint64_t, std::any>> retired_;
};

} // namespace sunfleck::gpu

// Buffers and images that own their memory. Move-only; destroyed at once, so the GPU must be done with them (see
// FrameResources::retire).
#pragma once

#include "engine/gpu/device.h"
#include "engine/gpu/resource_state.h"

#include <span>

namespace sunfleck::gpu {

struct BufferDescription {
    std::string name;
    VkDeviceSize size = 0; // bytes; 0 is made 16, so that a buffer can always be bound
    VkBufferUsageFlags usage = 0;
    MemoryUse memory = MemoryUse::device;
    VkFormat texel_format = VK_FORMAT_UNDEFINED; // not undefined: a texel buffer view over the whole buffer
};

class Buffer {
public:
    static Result<Buffer> create(Device& device, const BufferDescription& description);
    Buffer() = default;
    Buffer(Buffer&& other) noexcept { *this = std::move(other); }
    Buffer& operator=(Buffer&& other) noexcept;
    ~Buffer() { destroy(); }

    VkBuffer handle() const { return handle_; }
    VkBufferView texel_view() const { return texel_view_; }
    VkDeviceSize size() const { return size_; }
    std::byte* mapped() const { return static_cast<std::byte*>(allocation_.mapped); }
    explicit operator bool() const { return handle_ != VK_NULL_HANDLE; }
    const std::string& name() const { return name_; }
    // Where the last frame graph left it; graphs that import it start from here.
    ResourceState& state() const { return state_; }

private:
    void destroy();
    Device* device_ = nullptr;
    VkBuffer handle_ = VK_NULL_HANDLE;
    VkBufferView texel_view_ = VK_NULL_HANDLE;
    VkDeviceSize size_ = 0;
    Allocation allocation_;
    std::string name_;
    mutable ResourceState state_;
};

struct ImageDescription {
    std::string name;
    VkFormat format = VK_FORMAT_UNDEFINED;
    std::uint32_t width = 1, height = 1, layers = 1;
    std::uint32_t levels = 1; // of detail, each half the size of the one before
    VkImageUsageFlags usage = 0;
    bool array = false;        // the view is an array view even with one layer
    std::uint32_t samples = 1; // of a pixel: 1 or 4, which every device can have of colours and depth
    bool operator==(const ImageDescription&) const = default;
};

class Image {
public:
    static Result<Image> create(Device& device, const ImageDescription& description);
    Image() = default;
    Image(Image&& other) noexcept { *this = std::move(other); }
    Image& operator=(Image&& other) noexcept;
    ~Image() { destroy(); }

    VkImage handle() const { return handle_; }
    VkImageView view() const { return view_; }
    const ImageDescription& description() const { return description_; }
    VkImageAspectFlags aspect() const { return aspect_of(description_.format); }
    explicit operator bool() const { return handle_ != VK_NULL_HANDLE; }
    ResourceState& state() const { return state_; }

    static VkImageAspectFlags aspect_of(VkFormat format);

private:
    void destroy();
    Device* device_ = nullptr;
    VkImage handle_ = VK_NULL_HANDLE;
    VkImageView view_ = VK_NULL_HANDLE;
    Allocation allocation_;
    ImageDescription description_;
    mutable ResourceState state_;
};

} // namespace sunfleck::gpu

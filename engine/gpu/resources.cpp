#include "engine/gpu/resources.h"

#include "engine/gpu/texel_formats.h"

#include <algorithm>
#include <utility>

namespace sunfleck::gpu {
namespace {

// What lies behind a texel buffer's last texel is only there for its size, where the device has room for that.
VkDeviceSize padded_size(const Device& device, const BufferDescription& description, VkDeviceSize size) {
    if (description.texel_format == VK_FORMAT_UNDEFINED)
        return size;
    const VkDeviceSize padded = texel_buffer_bytes(size);
    return padded / texel_bytes(description.texel_format) > device.traits().max_texel_elements ? size : padded;
}

} // namespace

Result<Buffer> Buffer::create(Device& device, const BufferDescription& description) {
    Buffer buffer;
    buffer.device_ = &device;
    buffer.name_ = description.name;
    buffer.size_ = std::max<VkDeviceSize>(description.size, 16);
    if (const std::uint64_t texels = buffer.size_ / texel_bytes(description.texel_format);
        description.texel_format != VK_FORMAT_UNDEFINED && texels > device.traits().max_texel_elements)
        return Error{"creating buffer '" + description.name + "' failed: it has " + std::to_string(texels) +
                         " texels; this device's limit is " + std::to_string(device.traits().max_texel_elements),
                     ErrorCode::unsupported};
    VkBufferCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
    info.size = padded_size(device, description, buffer.size_);
    info.usage = description.usage;
    SUNFLECK_VK(device.vk.vkCreateBuffer(device.handle(), &info, nullptr, &buffer.handle_),
                "creating buffer '" + description.name + "'");
    VkMemoryRequirements requirements;
    device.vk.vkGetBufferMemoryRequirements(device.handle(), buffer.handle_, &requirements);
    SUNFLECK_ASSIGN(buffer.allocation_,
                    device.memory().allocate(requirements, description.memory, true, description.name));
    SUNFLECK_VK(device.vk.vkBindBufferMemory(device.handle(), buffer.handle_, buffer.allocation_.memory,
                                             buffer.allocation_.offset),
                "binding memory of buffer '" + description.name + "'");
    if (description.texel_format != VK_FORMAT_UNDEFINED) {
        VkBufferViewCreateInfo view{VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO};
        view.buffer = buffer.handle_;
        view.format = description.texel_format;
        view.range = VK_WHOLE_SIZE;
        SUNFLECK_VK(device.vk.vkCreateBufferView(device.handle(), &view, nullptr, &buffer.texel_view_),
                    "creating texel view of '" + description.name + "'");
    }
    device.set_name(VK_OBJECT_TYPE_BUFFER, std::uint64_t(buffer.handle_), description.name);
    return buffer;
}

Buffer& Buffer::operator=(Buffer&& other) noexcept {
    if (this == &other)
        return *this;
    destroy();
    device_ = other.device_;
    handle_ = std::exchange(other.handle_, VK_NULL_HANDLE);
    texel_view_ = std::exchange(other.texel_view_, VK_NULL_HANDLE);
    size_ = other.size_;
    allocation_ = std::exchange(other.allocation_, {});
    name_ = std::move(other.name_);
    state_ = other.state_;
    return *this;
}

void Buffer::destroy() {
    if (texel_view_ != VK_NULL_HANDLE)
        device_->vk.vkDestroyBufferView(device_->handle(), texel_view_, nullptr);
    if (handle_ != VK_NULL_HANDLE)
        device_->vk.vkDestroyBuffer(device_->handle(), handle_, nullptr);
    if (allocation_.memory != VK_NULL_HANDLE)
        device_->memory().free(allocation_, name_);
    texel_view_ = VK_NULL_HANDLE;
    handle_ = VK_NULL_HANDLE;
    allocation_ = {};
}

VkImageAspectFlags Image::aspect_of(VkFormat format) {
    switch (format) {
    case VK_FORMAT_D16_UNORM:
    case VK_FORMAT_X8_D24_UNORM_PACK32:
    case VK_FORMAT_D32_SFLOAT:
        return VK_IMAGE_ASPECT_DEPTH_BIT;
    case VK_FORMAT_D24_UNORM_S8_UINT:
    case VK_FORMAT_D32_SFLOAT_S8_UINT:
        return VK_IMAGE_ASPECT_DEPTH_BIT | VK_IMAGE_ASPECT_STENCIL_BIT;
    default:
        return VK_IMAGE_ASPECT_COLOR_BIT;
    }
}

Result<Image> Image::create(Device& device, const ImageDescription& description) {
    Image image;
    image.device_ = &device;
    image.description_ = description;
    const std::string doing = "creating image '" + description.name + "' of " + std::to_string(description.width) +
                              "x" + std::to_string(description.height);
    if (std::max(description.width, description.height) > device.traits().max_image_size)
        return Error{doing + " failed: this device's limit is " + std::to_string(device.traits().max_image_size) +
                         " in each direction",
                     ErrorCode::argument};
    VkImageCreateInfo info{VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
    info.imageType = VK_IMAGE_TYPE_2D;
    info.format = description.format;
    info.extent = {description.width, description.height, 1};
    info.mipLevels = description.levels;
    info.arrayLayers = description.layers;
    info.samples = VkSampleCountFlagBits(description.samples);
    info.usage = description.usage;
    SUNFLECK_VK(device.vk.vkCreateImage(device.handle(), &info, nullptr, &image.handle_), doing);
    VkMemoryRequirements requirements;
    device.vk.vkGetImageMemoryRequirements(device.handle(), image.handle_, &requirements);
    SUNFLECK_ASSIGN(image.allocation_,
                    device.memory().allocate(requirements, MemoryUse::device, false, description.name));
    SUNFLECK_VK(
        device.vk.vkBindImageMemory(device.handle(), image.handle_, image.allocation_.memory, image.allocation_.offset),
        doing);
    VkImageViewCreateInfo view{VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
    view.image = image.handle_;
    view.viewType = description.layers > 1 || description.array ? VK_IMAGE_VIEW_TYPE_2D_ARRAY : VK_IMAGE_VIEW_TYPE_2D;
    view.format = description.format;
    view.subresourceRange = {aspect_of(description.format), 0, description.levels, 0, description.layers};
    SUNFLECK_VK(device.vk.vkCreateImageView(device.handle(), &view, nullptr, &image.view_), doing);
    device.set_name(VK_OBJECT_TYPE_IMAGE, std::uint64_t(image.handle_), description.name);
    return image;
}

Image& Image::operator=(Image&& other) noexcept {
    if (this == &other)
        return *this;
    destroy();
    device_ = other.device_;
    handle_ = std::exchange(other.handle_, VK_NULL_HANDLE);
    view_ = std::exchange(other.view_, VK_NULL_HANDLE);
    allocation_ = std::exchange(other.allocation_, {});
    description_ = std::move(other.description_);
    state_ = other.state_;
    return *this;
}

void Image::destroy() {
    if (view_ != VK_NULL_HANDLE)
        device_->vk.vkDestroyImageView(device_->handle(), view_, nullptr);
    if (handle_ != VK_NULL_HANDLE)
        device_->vk.vkDestroyImage(device_->handle(), handle_, nullptr);
    if (allocation_.memory != VK_NULL_HANDLE)
        device_->memory().free(allocation_, description_.name);
    view_ = VK_NULL_HANDLE;
    handle_ = VK_NULL_HANDLE;
    allocation_ = {};
}

} // namespace sunfleck::gpu

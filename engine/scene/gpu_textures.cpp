#include "engine/scene/gpu_textures.h"

#include <algorithm>
#include <bit>

namespace sunfleck::scene {
namespace {

VkSamplerAddressMode address_mode(TextureWrap wrap) {
    switch (wrap) {
    case TextureWrap::repeat:
        return VK_SAMPLER_ADDRESS_MODE_REPEAT;
    case TextureWrap::mirrored_repeat:
        return VK_SAMPLER_ADDRESS_MODE_MIRRORED_REPEAT;
    default:
        return VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
    }
}

// All mip levels, one after the other.
std::vector<std::uint8_t> make_levels(const Texture& texture, std::vector<VkBufferImageCopy>& regions) {
    std::vector<std::uint8_t> all, level = texture.pixels;
    std::uint32_t width = texture.width, height = texture.height;
    for (std::uint32_t i = 0;; ++i) {
        VkBufferImageCopy region{};
        region.bufferOffset = all.size();
        region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, i, 0, 1};
        region.imageExtent = {width, height, 1};
        regions.push_back(region);
        all.insert(all.end(), level.begin(), level.end());
        if (width == 1 && height == 1)
            return all;
        level = half_size(level, width, height, texture.srgb);
        width = std::max(width / 2, 1u);
        height = std::max(height / 2, 1u);
    }
}

} // namespace

GpuTextures::~GpuTextures() {
    for (const auto& [mode, sampler] : by_mode_)
        device_.vk.vkDestroySampler(device_.handle(), sampler, nullptr);
}

Result<VkSampler> GpuTextures::sampler(const Texture& texture) {
    const std::uint32_t mode =
        std::uint32_t(texture.wrap_u) | std::uint32_t(texture.wrap_v) << 2 | (texture.nearest ? 16u : 0u);
    if (const auto found = by_mode_.find(mode); found != by_mode_.end())
        return found->second;
    VkSamplerCreateInfo info{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
    info.magFilter = texture.nearest ? VK_FILTER_NEAREST : VK_FILTER_LINEAR;
    info.minFilter = VK_FILTER_LINEAR;
    info.mipmapMode = VK_SAMPLER_MIPMAP_MODE_LINEAR;
    info.addressModeU = address_mode(texture.wrap_u);
    info.addressModeV = address_mode(texture.wrap_v);
    info.addressModeW = info.addressModeU;
    info.maxLod = VK_LOD_CLAMP_NONE;
    VkSampler made = VK_NULL_HANDLE;
    SUNFLECK_VK(device_.vk.vkCreateSampler(device_.handle(), &info, nullptr, &made), "creating a sampler");
    by_mode_[mode] = made;
    return made;
}

Result<gpu::Image> GpuTextures::upload(const Texture& texture, gpu::Submission& submission) {
    std::vector<VkBufferImageCopy> regions;
    const std::vector<std::uint8_t> bytes = make_levels(texture, regions);
    gpu::ImageDescription description;
    description.name = texture.name;
    description.format = texture.srgb ? VK_FORMAT_R8G8B8A8_SRGB : VK_FORMAT_R8G8B8A8_UNORM;
    description.width = texture.width;
    description.height = texture.height;
    description.levels = std::uint32_t(regions.size());
    SUNFLECK_ASSIGN(gpu::Image image, gpu::make_sampled_image(device_, submission, description,
                                                              std::as_bytes(std::span(bytes)), regions));
    memory_bytes_ += bytes.size();
    return image;
}

Status GpuTextures::update(const TextureStore& textures, gpu::Submission& submission) {
    const auto add = [&](const Texture& texture) -> Status {
        SUNFLECK_ASSIGN(const VkSampler mode, sampler(texture));
        SUNFLECK_ASSIGN(gpu::Image image, upload(texture, submission));
        images_.push_back(std::move(image));
        samplers_.push_back(mode);
        return {};
    };
    if (images_.empty()) {
        Texture white;
        white.name = "white";
        white.width = white.height = 1;
        white.pixels.assign(4, 255);
        SUNFLECK_TRY(add(white));
    }
    for (std::uint32_t i = std::uint32_t(images_.size()) - 1; i < textures.size(); ++i)
        SUNFLECK_TRY(add(textures[i]));
    return {};
}

gpu::Binding GpuTextures::binding(std::int32_t texture) const {
    const std::size_t place = texture >= 0 && std::size_t(texture) + 1 < images_.size() ? std::size_t(texture) + 1 : 0;
    return gpu::Binding::sampled_image(images_[place].view(), samplers_[place]);
}

} // namespace sunfleck::scene

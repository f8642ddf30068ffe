#include "engine/render/sky.h"

#include <glm/gtc/packing.hpp>

namespace sunfleck::render {

SkyImage::~SkyImage() {
    device_.vk.vkDestroySampler(device_.handle(), sampler_, nullptr);
}

Status SkyImage::update(const scene::EnvironmentImage* picture, gpu::Submission& submission) {
    if (picture == shown_ && image_)
        return {};
    if (sampler_ == VK_NULL_HANDLE) {
        VkSamplerCreateInfo info{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
        info.magFilter = info.minFilter = VK_FILTER_LINEAR;
        info.addressModeU = VK_SAMPLER_ADDRESS_MODE_REPEAT;
        info.addressModeV = info.addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
        SUNFLECK_VK(device_.vk.vkCreateSampler(device_.handle(), &info, nullptr, &sampler_), "creating a sampler");
    }
    std::vector<std::uint64_t> halves(1, 0);
    gpu::ImageDescription description;
    description.name = "sky";
    description.format = VK_FORMAT_R16G16B16A16_SFLOAT;
    if (picture != nullptr) {
        description.width = picture->width();
        description.height = picture->height();
        halves.clear();
        for (const vec3 texel : picture->texels())
            halves.push_back(glm::packHalf4x16(vec4(glm::min(texel, vec3(65000.0f)), 1.0f)));
    }
    VkBufferImageCopy region{};
    region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    region.imageExtent = {description.width, description.height, 1};
    SUNFLECK_TRY(device_.wait_idle());
    SUNFLECK_ASSIGN(image_, gpu::make_sampled_image(device_, submission, description, std::as_bytes(std::span(halves)),
                                                    std::span(&region, 1)));
    shown_ = picture;
    return {};
}

} // namespace sunfleck::render

#include "editor/window/picture_upload.h"

#include <algorithm>
#include <cmath>

namespace sunfleck::editor {

Result<std::shared_ptr<ScenePicture>> upload_picture(gpu::Device& device, gpu::Submission& submission,
                                                     const io::Picture& picture) {
    auto result = std::make_shared<ScenePicture>();
    auto rounded = std::make_shared<io::Picture>(picture);
    std::vector<std::byte> bytes(picture.pixels.size() * 4);
    for (std::size_t i = 0; i < picture.pixels.size(); ++i)
        for (int channel = 0; channel < 4; ++channel) {
            const float value = std::round(std::clamp(picture.pixels[i][channel], 0.0f, 1.0f) * 255.0f);
            bytes[i * 4 + std::size_t(channel)] = std::byte(value);
            rounded->pixels[i][channel] = value / 255.0f;
        }
    gpu::ImageDescription description;
    description.name = "compared picture";
    description.format = VK_FORMAT_R8G8B8A8_UNORM;
    description.width = picture.width;
    description.height = picture.height;
    description.usage = VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    VkBufferImageCopy region{};
    region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    region.imageExtent = {picture.width, picture.height, 1};
    SUNFLECK_ASSIGN(result->image, gpu::make_sampled_image(device, submission, description, bytes, {&region, 1}));
    result->image.state().layout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
    result->settled = true;
    result->pixels = std::move(rounded);
    return result;
}

} // namespace sunfleck::editor

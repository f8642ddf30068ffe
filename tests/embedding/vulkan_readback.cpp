// The program's pictures as numbers.
#include "vulkan_program.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace {

void require(VkResult result, const char* what) {
    if (result == VK_SUCCESS)
        return;
    std::fprintf(stderr, "%s failed (%d)\n", what, int(result));
    std::exit(1);
}

float half_to_float(std::uint16_t half) {
    const int exponent = half >> 10 & 31, mantissa = half & 1023;
    const float value = exponent == 0    ? std::ldexp(float(mantissa), -24)
                        : exponent == 31 ? std::nanf("")
                                         : std::ldexp(float(mantissa + 1024), exponent - 25);
    return half >> 15 ? -value : value;
}

} // namespace

bool VulkanProgram::has_depth_format(VkFormat format) const {
    const VkFormatFeatureFlags needed =
        VK_FORMAT_FEATURE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT;
    VkFormatProperties properties;
    vkGetPhysicalDeviceFormatProperties(physical_device, format, &properties);
    return (properties.optimalTilingFeatures & needed) == needed;
}

std::vector<float> VulkanProgram::read(TargetImage& image) {
    VkBuffer buffer = VK_NULL_HANDLE;
    VkDeviceMemory memory = VK_NULL_HANDLE;
    make_buffer(nullptr, width * height * 8, VK_BUFFER_USAGE_TRANSFER_DST_BIT, buffer, memory);
    frame(
        {}, [] {}, [] { return std::array<float, 16>{}; },
        [&](VkCommandBuffer commands) {
            transition(
                commands, image,
                {VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_READ_BIT},
                false);
            VkBufferImageCopy region{};
            region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
            region.imageExtent = {width, height, 1};
            vkCmdCopyImageToBuffer(commands, image.image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, buffer, 1, &region);
        });
    wait();
    void* mapped = nullptr;
    require(vkMapMemory(device, memory, 0, VK_WHOLE_SIZE, 0, &mapped), "vkMapMemory");
    const auto* halves = static_cast<const std::uint16_t*>(mapped);
    std::vector<float> numbers(std::size_t(width) * height * 4);
    for (std::size_t i = 0; i < numbers.size(); ++i)
        numbers[i] = half_to_float(halves[i]);
    vkDestroyBuffer(device, buffer, nullptr);
    vkFreeMemory(device, memory, nullptr);
    return numbers;
}

std::array<double, 3> VulkanProgram::mean_irradiance(bool& finite) {
    const std::vector<float> numbers = read(irradiance);
    std::array<double, 3> sum{};
    finite = true;
    for (std::size_t i = 0; i < std::size_t(width) * height; ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            const float value = numbers[i * 4 + c];
            finite = finite && std::isfinite(value);
            sum[c] += double(value) / (width * height);
        }
    return sum;
}

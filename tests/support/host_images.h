// What a host hands to `record`, of one size: the inside of a box, computed on the CPU, as its G-buffer, in each way
// that tests ask for, and the images that are written.
#pragma once

#include "tests/support/gpu_device.h"

#include "engine/core/octahedral.h"
#include "engine/gpu/submission.h"
#include "engine/scene/camera_shared.h"
#include "sunfleck/host.h"

#include <array>
#include <bit>

namespace sunfleck::tests {

// Which of the optional images are there, and whether normals are shading normals alone, of half floats.
struct HostOptions {
    bool shading_normals = false, geometric_normals = false, motion = false, metallic_roughness = false,
         specular = false;
};

class HostImages {
public:
    HostImages(gpu::Device& device, std::uint32_t width, std::uint32_t height)
        : device_(device), width_(width), height_(height) {
        for (std::size_t i = 0; i < inputs_.size(); ++i) {
            const VkImageUsageFlags usage =
                i == depth ? VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT : VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
            inputs_[i].image = make_image(kinds[i].name, kinds[i].format, usage);
            inputs_[i].offset = i == 0 ? 0 : inputs_[i - 1].offset + VkDeviceSize(pixels()) * kinds[i - 1].bytes;
        }
        irradiance_ = make_image("irradiance", VK_FORMAT_R16G16B16A16_SFLOAT, VK_IMAGE_USAGE_STORAGE_BIT);
        specular_ = make_image("specular light", VK_FORMAT_R16G16B16A16_SFLOAT, VK_IMAGE_USAGE_STORAGE_BIT);
    }
    std::uint32_t width() const { return width_; }
    std::uint32_t height() const { return height_; }
    std::uint32_t pixels() const { return width_ * height_; }
    const gpu::Image& irradiance() const { return irradiance_; }
    static constexpr VkDeviceSize bytes_per_pixel = 40;

    host::FrameImages images(const HostOptions& options) const {
        host::FrameImages images{width_, height_};
        images.depth = input(depth);
        images.normals = input(options.shading_normals ? half_normals : normals);
        images.surface = input(surface);
        images.irradiance = {irradiance_.handle(), irradiance_.view(), {}, transfer_read()};
        if (options.geometric_normals)
            images.geometric_normals = input(flat_normals);
        if (options.motion)
            images.motion = input(motion);
        if (options.metallic_roughness)
            images.metallic_roughness = input(metallic_roughness);
        if (options.specular)
            images.specular = {specular_.handle(), specular_.view(), {}, transfer_read()};
        return images;
    }
    // Fills all inputs: everything is of one surface.
    void draw(VkCommandBuffer commands, const gpu::Buffer& upload, const host::Camera& camera,
              std::uint32_t surface_id) const {
        write_box(upload.mapped(), camera, surface_id);
        transition(commands, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
        for (const Input& input : inputs_) {
            const VkBufferImageCopy region = region_of(input.image, input.offset);
            device_.vk.vkCmdCopyBufferToImage(commands, upload.handle(), input.image.handle(),
                                              VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region);
        }
        transition(commands, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
    }
    VkBufferImageCopy region_of(const gpu::Image& image, VkDeviceSize offset) const {
        VkBufferImageCopy region{};
        region.bufferOffset = offset;
        region.imageSubresource = {aspect(image), 0, 0, 1};
        region.imageExtent = {width_, height_, 1};
        return region;
    }

private:
    enum Number { depth, normals, surface, half_normals, flat_normals, motion, metallic_roughness, count };
    struct Kind {
        const char* name;
        VkFormat format;
        VkDeviceSize bytes;
    };
    static constexpr std::array<Kind, count> kinds = {{
        {"depth", VK_FORMAT_D32_SFLOAT, 4},
        {"normals", VK_FORMAT_R32G32_UINT, 8},
        {"surface", VK_FORMAT_R32_UINT, 4},
        {"shading normals", VK_FORMAT_R16G16B16A16_SFLOAT, 8},
        {"geometric normals", VK_FORMAT_R16G16B16A16_SFLOAT, 8},
        {"motion", VK_FORMAT_R16G16_SFLOAT, 4},
        {"metallic and roughness", VK_FORMAT_R8G8B8A8_UNORM, 4},
    }};
    struct Input {
        gpu::Image image;
        VkDeviceSize offset = 0; // in the upload
    };

    gpu::Image make_image(const char* name, VkFormat format, VkImageUsageFlags usage) const {
        gpu::ImageDescription description;
        description.name = name;
        description.format = format;
        description.width = width_;
        description.height = height_;
        description.usage =
            usage | VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
        return gpu::Image::create(device_, description).value();
    }
    static VkImageAspectFlags aspect(const gpu::Image& image) {
        return gpu::Image::aspect_of(image.description().format);
    }
    static host::ImageState transfer_read() {
        return {VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_READ_BIT};
    }
    host::HostImage input(Number number) const {
        const host::ImageState state{VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                                     VK_ACCESS_2_SHADER_SAMPLED_READ_BIT};
        const gpu::Image& image = inputs_[number].image;
        return {image.handle(), image.view(), state, state, kinds[number].format};
    }
    void transition(VkCommandBuffer commands, VkImageLayout from, VkImageLayout to) const {
        std::array<VkImageMemoryBarrier2, count> barriers{};
        for (std::size_t i = 0; i < barriers.size(); ++i) {
            VkImageMemoryBarrier2& barrier = barriers[i];
            barrier.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2;
            barrier.srcStageMask = barrier.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
            barrier.srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT;
            barrier.dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
            barrier.oldLayout = from;
            barrier.newLayout = to;
            barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
            barrier.image = inputs_[i].image.handle();
            barrier.subresourceRange = {aspect(inputs_[i].image), 0, 1, 0, 1};
        }
        VkDependencyInfo dependency{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
        dependency.imageMemoryBarrierCount = std::uint32_t(barriers.size());
        dependency.pImageMemoryBarriers = barriers.data();
        device_.vk.vkCmdPipelineBarrier2(commands, &dependency);
    }
    // The inside of the box from (-2, 0, -2) to (2, 2.5, 2).
    void write_box(std::byte* memory, const host::Camera& camera, std::uint32_t surface_id) const {
        const auto at = [&](Number number, std::uint32_t word) -> std::uint32_t& {
            return reinterpret_cast<std::uint32_t*>(memory + inputs_[number].offset)[word];
        };
        const float scale = std::tan(0.5f * camera.vertical_field_of_view);
        for (std::uint32_t i = 0; i < pixels(); ++i) {
            const std::uint32_t column = i % width_, row = i / width_;
            const float x = (2.0f * (float(column) + 0.5f) / float(width_) - 1.0f) * scale;
            const float y = (1.0f - 2.0f * (float(row) + 0.5f) / float(height_)) * scale;
            // Of a length of 1 along the axis.
            const vec3 direction(x * float(width_) / float(height_), y, -1.0f);
            const auto [distance, normal] = hit(camera, direction);
            at(depth, i) = std::bit_cast<std::uint32_t>(0.01f / distance);
            at(normals, 2 * i) = at(normals, 2 * i + 1) = shared::pack_normal(normal);
            at(surface, i) = surface_id;
            for (const Number number : {half_normals, flat_normals}) {
                at(number, 2 * i) = glm::packHalf2x16({normal.x, normal.y});
                at(number, 2 * i + 1) = glm::packHalf2x16({normal.z, 0.0f});
            }
            at(motion, i) = 0;
            at(metallic_roughness, i) = 0x40ff; // a metal, quite smooth
        }
    }
    static std::pair<float, vec3> hit(const host::Camera& camera, vec3 direction) {
        const vec3 eye(camera.position[0], camera.position[1], camera.position[2]);
        const vec3 low(-2.0f, 0.0f, -2.0f), high(2.0f, 2.5f, 2.0f);
        float distance = 1e9f;
        vec3 normal(0.0f);
        for (int axis = 0; axis < 3; ++axis) {
            if (direction[axis] == 0.0f)
                continue;
            const float wall = direction[axis] > 0.0f ? high[axis] : low[axis];
            const float t = (wall - eye[axis]) / direction[axis];
            if (t >= distance)
                continue;
            distance = t;
            normal = vec3(0.0f);
            normal[axis] = direction[axis] > 0.0f ? -1.0f : 1.0f;
        }
        return {distance, normal};
    }

    gpu::Device& device_;
    std::uint32_t width_, height_;
    std::array<Input, count> inputs_;
    gpu::Image irradiance_, specular_;
};

} // namespace sunfleck::tests

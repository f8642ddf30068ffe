// A program that lights its frames by sunfleck/host.h alone, without a geometry pass: its G-buffer is the inside of a
// box, computed on the CPU, so that a frame costs little more than the calls that are tested.
#pragma once

#include "tests/support/gpu_world.h"

#include "engine/core/octahedral.h"
#include "engine/scene/camera_shared.h"
#include "sunfleck/host.h"

#include <bit>

namespace sunfleck::tests {

struct HostPicture {
    std::vector<std::uint64_t> pixels; // RGBA of halves
    bool operator==(const HostPicture&) const = default;
};

// Calls of sunfleck/host.h that this thread is within.
inline thread_local int host_calls = 0;
struct HostCall {
    HostCall() { ++host_calls; }
    ~HostCall() { --host_calls; }
    HostCall(const HostCall&) = delete;
    HostCall& operator=(const HostCall&) = delete;
};

class HostProgram {
public:
    static constexpr std::uint32_t width = 32, height = 32;

    explicit HostProgram(gpu::Device& device) : device_(device) {
        submission_ = gpu::Submission::create(device, 2).value();
        depth_ = make_image("depth", VK_FORMAT_D32_SFLOAT, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT);
        normals_ = make_image("normals", VK_FORMAT_R32G32_UINT, 0);
        surface_ = make_image("surface", VK_FORMAT_R32_UINT, 0);
        irradiance_ = make_image("irradiance", VK_FORMAT_R16G16B16A16_SFLOAT, VK_IMAGE_USAGE_STORAGE_BIT);
        for (gpu::Buffer& buffer : uploads_)
            buffer = make_buffer(VK_BUFFER_USAGE_TRANSFER_SRC_BIT, gpu::MemoryUse::upload);
        read_back_ = make_buffer(VK_BUFFER_USAGE_TRANSFER_DST_BIT, gpu::MemoryUse::readback);
    }
    ~HostProgram() { static_cast<void>(device_.wait_idle()); }
    HostProgram(const HostProgram&) = delete;
    HostProgram& operator=(const HostProgram&) = delete;

    host::VulkanHandles handles() const {
        return {device_.instance(), device_.physical_device(), device_.handle(), device_.queue(),
                device_.queue_family()};
    }
    gpu::Device& device() const { return device_; }
    const host::Camera& camera() const { return camera_; }
    host::FrameImages images() const {
        host::FrameImages images{width, height};
        images.depth = input(depth_);
        images.normals = input(normals_);
        images.surface = input(surface_);
        images.irradiance = {irradiance_.handle(), irradiance_.view(), {}, transfer_read()};
        return images;
    }
    // The next frame's numbers. Waits until its slot is free.
    host::Frame next_frame() {
        commands_ = submission_->begin().value();
        host::Frame frame;
        frame.serial = submission_->serial();
        frame.completed_serial = submission_->completed().value();
        return frame;
    }
    VkCommandBuffer commands() const { return commands_; }
    // Fills the G-buffer: everything is of one surface. Before recording.
    void draw(std::uint32_t surface) {
        gpu::Buffer& upload = uploads_[submission_->serial() % 2];
        write_box(reinterpret_cast<std::uint32_t*>(upload.mapped()), surface);
        for (const gpu::Image* image : {&depth_, &normals_, &surface_})
            transition(image->handle(), aspect(*image), VK_IMAGE_LAYOUT_UNDEFINED,
                       VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
        copy(upload, depth_, 0);
        copy(upload, normals_, pixels * 4);
        copy(upload, surface_, pixels * 12);
        for (const gpu::Image* image : {&depth_, &normals_, &surface_})
            transition(image->handle(), aspect(*image), VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                       VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
    }
    // Submits what is recorded; submit_empty: throws it away, as after a record that failed.
    void submit() { ASSERT_TRUE(submission_->submit()); }
    void submit_empty() {
        ASSERT_TRUE(submission_->begin()); // resets it
        ASSERT_TRUE(submission_->submit());
    }
    void wait() { ASSERT_TRUE(device_.wait_idle()); }

    // A frame; the surface is that of `instance`.
    Status frame(host::Context& context, std::uint32_t instance) {
        const host::Frame frame = next_frame();
        Status status = [&] {
            const HostCall call;
            return context.update(frame);
        }();
        if (status) {
            draw(context.surface_id(instance));
            const host::FrameImages all = images();
            const HostCall call;
            status = context.record(commands_, camera_, all);
        }
        if (status)
            submit();
        else
            submit_empty();
        return status;
    }
    // Frames until nothing is left to be done over several of them.
    Status settle(host::Context& context, std::uint32_t instance) {
        for (int i = 0; i < 80; ++i) {
            SUNFLECK_TRY(frame(context, instance));
            double waiting = 0;
            for (const host::Statistic& counter : context.statistics().counters)
                if (counter.name == "baked_light_waiting" || counter.name == "shadow_maps_stale" ||
                    counter.name == "shadow_tiles_stale")
                    waiting += counter.value;
            if (waiting == 0)
                return frame(context, instance);
        }
        return Error{"the picture did not settle in 80 frames"};
    }
    // Of the last frame. Waits.
    HostPicture picture() {
        EXPECT_TRUE(submission_->immediate([&](VkCommandBuffer commands) -> Status {
            VkBufferImageCopy region = region_of(irradiance_, 0);
            device_.vk.vkCmdCopyImageToBuffer(commands, irradiance_.handle(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                                              read_back_.handle(), 1, &region);
            VkMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2, nullptr,
                                     VK_PIPELINE_STAGE_2_COPY_BIT,       VK_ACCESS_2_TRANSFER_WRITE_BIT,
                                     VK_PIPELINE_STAGE_2_HOST_BIT,       VK_ACCESS_2_HOST_READ_BIT};
            VkDependencyInfo dependency{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
            dependency.memoryBarrierCount = 1;
            dependency.pMemoryBarriers = &barrier;
            device_.vk.vkCmdPipelineBarrier2(commands, &dependency);
            return {};
        }));
        const auto* first = reinterpret_cast<const std::uint64_t*>(read_back_.mapped());
        return {{first, first + pixels}};
    }

private:
    static constexpr std::uint32_t pixels = width * height;

    gpu::Image make_image(const char* name, VkFormat format, VkImageUsageFlags usage) const {
        gpu::ImageDescription description;
        description.name = name;
        description.format = format;
        description.width = width;
        description.height = height;
        description.usage =
            usage | VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
        return gpu::Image::create(device_, description).value();
    }
    gpu::Buffer make_buffer(VkBufferUsageFlags usage, gpu::MemoryUse memory) const {
        gpu::BufferDescription description;
        description.name = "host program";
        description.size = pixels * 16;
        description.usage = usage;
        description.memory = memory;
        return gpu::Buffer::create(device_, description).value();
    }
    static VkImageAspectFlags aspect(const gpu::Image& image) {
        return gpu::Image::aspect_of(image.description().format);
    }
    static host::ImageState transfer_read() {
        return {VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_READ_BIT};
    }
    static host::HostImage input(const gpu::Image& image) {
        const host::ImageState state{VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                                     VK_ACCESS_2_SHADER_SAMPLED_READ_BIT};
        return {image.handle(), image.view(), state, state};
    }
    VkBufferImageCopy region_of(const gpu::Image& image, VkDeviceSize offset) const {
        VkBufferImageCopy region{};
        region.bufferOffset = offset;
        region.imageSubresource = {aspect(image), 0, 0, 1};
        region.imageExtent = {width, height, 1};
        return region;
    }
    void copy(const gpu::Buffer& from, const gpu::Image& to, VkDeviceSize offset) const {
        const VkBufferImageCopy region = region_of(to, offset);
        device_.vk.vkCmdCopyBufferToImage(commands_, from.handle(), to.handle(), VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                                          1, &region);
    }
    void transition(VkImage image, VkImageAspectFlags aspect, VkImageLayout from, VkImageLayout to) const {
        VkImageMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2};
        barrier.srcStageMask = barrier.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
        barrier.srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT;
        barrier.dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
        barrier.oldLayout = from;
        barrier.newLayout = to;
        barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
        barrier.image = image;
        barrier.subresourceRange = {aspect, 0, 1, 0, 1};
        VkDependencyInfo dependency{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
        dependency.imageMemoryBarrierCount = 1;
        dependency.pImageMemoryBarriers = &barrier;
        device_.vk.vkCmdPipelineBarrier2(commands_, &dependency);
    }
    // The inside of the box from (-2, 0, -2) to (2, 2.5, 2): depth, normals, surface ids.
    void write_box(std::uint32_t* to, std::uint32_t surface) const {
        const vec3 eye(camera_.position[0], camera_.position[1], camera_.position[2]);
        const vec3 low(-2.0f, 0.0f, -2.0f), high(2.0f, 2.5f, 2.0f);
        const float scale = std::tan(0.5f * camera_.vertical_field_of_view);
        for (std::uint32_t i = 0; i < pixels; ++i) {
            const std::uint32_t column = i % width, row = i / width;
            const float x = (2.0f * (float(column) + 0.5f) / float(width) - 1.0f) * scale;
            const float y = (1.0f - 2.0f * (float(row) + 0.5f) / float(height)) * scale;
            const vec3 direction(x, y, -1.0f); // its length along the axis is 1
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
            to[i] = std::bit_cast<std::uint32_t>(0.01f / distance);
            to[pixels + 2 * i] = to[pixels + 2 * i + 1] = shared::pack_normal(normal);
            to[3 * pixels + i] = surface;
        }
    }

    gpu::Device& device_;
    std::unique_ptr<gpu::Submission> submission_;
    gpu::Image depth_, normals_, surface_, irradiance_;
    gpu::Buffer uploads_[2], read_back_;
    VkCommandBuffer commands_ = VK_NULL_HANDLE;
    host::Camera camera_{{0.1f, 1.2f, 1.8f}};
};

// A cube from -0.5 to 0.5, 24 vertices; inwards: a room.
inline host::MeshData cube(bool inwards) {
    struct Data {
        std::vector<float> positions, normals;
        std::vector<std::uint32_t> indices;
        explicit Data(bool in) {
            for (int axis = 0; axis < 3; ++axis)
                for (const float side : {-0.5f, 0.5f}) {
                    const std::uint32_t first = std::uint32_t(positions.size() / 3);
                    for (int corner = 0; corner < 4; ++corner) {
                        float point[3], normal[3] = {0, 0, 0};
                        point[axis] = side;
                        point[(axis + 1) % 3] = (corner & 1) != 0 ? 0.5f : -0.5f;
                        point[(axis + 2) % 3] = (corner & 2) != 0 ? 0.5f : -0.5f;
                        normal[axis] = (side > 0.0f) != in ? 1.0f : -1.0f;
                        positions.insert(positions.end(), point, point + 3);
                        normals.insert(normals.end(), normal, normal + 3);
                    }
                    const bool turned = (side > 0.0f) == in;
                    for (const std::uint32_t i : {0u, 1u, 3u, 0u, 3u, 2u})
                        indices.push_back(first + (turned && i != 0 && i != 3 ? 3 - i : i));
                }
        }
    };
    static const Data out(false), in(true);
    const Data& data = inwards ? in : out;
    return {data.positions, data.normals, data.indices, {}};
}

inline host::Matrix4 box_matrix(vec3 centre, vec3 size) {
    return {size.x, 0, 0, 0, 0, size.y, 0, 0, 0, 0, size.z, 0, centre.x, centre.y, centre.z, 1};
}

template <typename T>
Status without_value(const Result<T>& result) {
    return result ? Status() : Status(result.error());
}

// A room with a box that moves and a lamp.
inline void describe_room(host::Context& context) {
    for (const auto& [name, value] : {std::pair("lights", "16"), std::pair("shadow_map_resolution", "32")})
        ASSERT_TRUE(context.set(name, value));
    ASSERT_TRUE(context.add_mesh(cube(true)));
    ASSERT_TRUE(context.add_mesh(cube(false)));
    ASSERT_TRUE(context.add_instance(
        {0, box_matrix(vec3(0, 1.25f, 0), vec3(4, 2.5f, 4)), host::Mobility::fixed, {0.7f, 0.6f, 0.5f}}));
    ASSERT_TRUE(context.add_instance({1, box_matrix(vec3(0.4f, 0.6f, 0), vec3(0.6f)), host::Mobility::moving}));
    ASSERT_TRUE(context.add_light({host::LightKind::point, {5, 4, 3}, {-0.5f, 2.0f, 0.5f}}));
}

// A context that is destroyed when the GPU has finished its frames, as its contract has it.
struct WaitThenDestroy {
    gpu::Device* device = nullptr;
    void operator()(host::Context* context) const {
        static_cast<void>(device->wait_idle());
        delete context;
    }
};
using OwnedContext = std::unique_ptr<host::Context, WaitThenDestroy>;

inline OwnedContext make_context(const HostProgram& program, host::LogSink log = {}) {
    auto context = host::Context::create(program.handles(), std::move(log));
    EXPECT_TRUE(context) << context.error().message;
    return {std::move(context).value().release(), WaitThenDestroy{&program.device()}};
}

inline HostPicture picture_of_room(HostProgram& program, host::Context& context) {
    const Status settled = program.settle(context, 0);
    EXPECT_TRUE(settled) << settled.error().message;
    return program.picture();
}

} // namespace sunfleck::tests

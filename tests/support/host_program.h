// A program that lights its frames by sunfleck/host.h alone, without a geometry pass: its G-buffer is computed on the
// CPU, so that a frame costs little more than the calls that are tested.
#pragma once

#include "tests/support/host_images.h"

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
    explicit HostProgram(gpu::Device& device) : device_(device), large_(device, 32, 32), small_(device, 24, 16) {
        submission_ = gpu::Submission::create(device, 2).value();
        for (gpu::Buffer& buffer : uploads_)
            buffer = make_buffer(device, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, gpu::MemoryUse::upload);
        read_back_ = make_buffer(device, VK_BUFFER_USAGE_TRANSFER_DST_BIT, gpu::MemoryUse::readback);
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
    // Frames from here on have a picture of 24x16, or again of 32x32.
    void resize(bool small) { now_ = small ? &small_ : &large_; }
    std::uint32_t width() const { return now_->width(); }
    std::uint32_t height() const { return now_->height(); }
    host::FrameImages images(const HostOptions& options = {}) const { return now_->images(options); }
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
    void draw(std::uint32_t surface) { now_->draw(commands_, uploads_[submission_->serial() % 2], camera_, surface); }
    // Submits what is recorded; submit_empty: throws it away, as after a record that failed.
    void submit() { ASSERT_TRUE(submission_->submit()); }
    void submit_empty() {
        ASSERT_TRUE(submission_->begin()); // resets it
        ASSERT_TRUE(submission_->submit());
    }
    void wait() { ASSERT_TRUE(device_.wait_idle()); }

    // A frame; the surface is that of `instance`.
    Status frame(host::Context& context, std::uint32_t instance, const HostOptions& options = {}) {
        const host::Frame frame = next_frame();
        Status status = [&] {
            const HostCall call;
            return context.update(frame);
        }();
        if (status) {
            draw(context.surface_id(instance));
            const host::FrameImages all = images(options);
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
                if (counter.name == "baked_light_waiting" || counter.name == "refined_light_waiting" ||
                    counter.name == "shadow_maps_stale" || counter.name == "shadow_tiles_stale")
                    waiting += counter.value;
            if (waiting == 0)
                return frame(context, instance);
        }
        return Error{"the picture did not settle in 80 frames"};
    }
    // Of the last frame. Waits.
    HostPicture picture() {
        EXPECT_TRUE(submission_->immediate([&](VkCommandBuffer commands) -> Status {
            const VkBufferImageCopy region = now_->region_of(now_->irradiance(), 0);
            device_.vk.vkCmdCopyImageToBuffer(commands, now_->irradiance().handle(),
                                              VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, read_back_.handle(), 1, &region);
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
        return {{first, first + now_->pixels()}};
    }

private:
    static gpu::Buffer make_buffer(gpu::Device& device, VkBufferUsageFlags usage, gpu::MemoryUse memory) {
        gpu::BufferDescription description;
        description.name = "host program";
        description.size = 32 * 32 * HostImages::bytes_per_pixel;
        description.usage = usage;
        description.memory = memory;
        return gpu::Buffer::create(device, description).value();
    }

    gpu::Device& device_;
    std::unique_ptr<gpu::Submission> submission_;
    HostImages large_, small_; // pictures of two sizes
    HostImages* now_ = &large_;
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

// Refused, by a message that names what was wrong.
inline void expect_argument(const Status& status, const std::string& word) {
    ASSERT_FALSE(status) << word;
    EXPECT_EQ(status.error().code, ErrorCode::argument) << status.error().message;
    EXPECT_NE(status.error().message.find(word), std::string::npos) << status.error().message;
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

// A scene with its renderer, on the test program's device.
#pragma once

#include "assets/test_rooms.h"
#include "tests/support/gpu_device.h"
#include "viewer/scene_renderer.h"

namespace sunfleck::tests {

struct GpuWorld {
    GpuWorld() {
        auto made = viewer::SceneRenderer::create(device());
        if (!made) {
            ADD_FAILURE() << made.error().message;
            std::abort();
        }
        renderer = std::move(made).value();
        request.width = 64;
        request.height = 48;
        request.view = shared::view_irradiance;
        request.tone_map = false;
    }
    explicit GpuWorld(void (*make)(assets::SceneBuilder&), const std::string& camera = "") : GpuWorld() {
        assets::SceneBuilder builder(renderer->registry(), renderer->meshes());
        make(builder);
        finish(camera);
    }
    void finish(const std::string& camera = "") {
        scene::update_world_transforms(renderer->registry());
        EXPECT_TRUE(renderer->upload_meshes());
        const Bounds bounds = viewer::scene_bounds(renderer->registry(), renderer->meshes());
        auto view = viewer::find_camera(renderer->registry(), bounds, camera);
        EXPECT_TRUE(view);
        request.camera = *view;
    }
    void set(const gi::Settings& settings) {
        const Status status = renderer->lighting().set_settings(settings);
        EXPECT_TRUE(status) << status.error().message;
    }
    void render() {
        const Status status = renderer->render_and_wait(request);
        ASSERT_TRUE(status) << status.error().message;
    }
    io::Picture picture() {
        render();
        auto result = renderer->read_back();
        EXPECT_TRUE(result);
        return result ? *result : io::Picture{};
    }

    std::unique_ptr<viewer::SceneRenderer> renderer;
    viewer::FrameRequest request;
};

// The first `bytes` of a device buffer, in memory that the CPU reads.
inline gpu::Buffer read_back(GpuWorld& world, const gpu::Buffer& source, std::uint64_t bytes) {
    gpu::BufferDescription description;
    description.name = "test read-back";
    description.size = bytes;
    description.usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT;
    description.memory = gpu::MemoryUse::readback;
    gpu::Buffer target = gpu::Buffer::create(device(), description).value();
    EXPECT_TRUE(world.renderer->submission().immediate([&](VkCommandBuffer commands) -> Status {
        gpu::FrameGraph graph(&device());
        const auto from = graph.import_buffer(source), to = graph.import_buffer(target);
        graph.add_pass("copy")
            .read(from, gpu::Usage::transfer_source)
            .write(to, gpu::Usage::transfer_destination)
            .execute([&](gpu::PassContext& context) -> Status {
                const VkBufferCopy region{0, 0, bytes};
                context.device.vk.vkCmdCopyBuffer(context.commands, source.handle(), target.handle(), 1, &region);
                return {};
            });
        graph.add_pass("host").read(to, gpu::Usage::host_read).keep();
        SUNFLECK_TRY(graph.compile());
        gpu::FrameResources resources(device());
        return graph.execute(commands, resources, nullptr);
    }));
    return target;
}

} // namespace sunfleck::tests

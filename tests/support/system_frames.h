// One scene and any number of gi::Systems that light it, frame by frame, with frames that get lost on the way.
#pragma once

#include "engine/render/g_buffer.h"
#include "engine/scene/deformation.h"
#include "engine/simulation/path_movers.h"
#include "tests/support/gpu_world.h"

namespace sunfleck::gpu {
std::span<const EmbeddedShader> sunfleck_render_shaders();
}

namespace sunfleck::tests {

// A room where all stays but one box.
inline void make_moving_box_room(assets::SceneBuilder& scene) {
    const vec3 white(0.7f), red(0.7f, 0.3f, 0.3f);
    scene.room(vec3(-2, 0, -2), vec3(2, 2.5f, 2), white, white, {red, white, white, white},
               {{"lamp", vec2(0.5f, 0.3f), 0.6f, 0.6f, vec3(9.0f)}});
    scene.box("pillar", vec3(-0.9f, 0.0f, -0.9f), vec3(-0.6f, 1.8f, -0.6f), assets::diffuse(white));
    const ecs::Entity box = scene.box("box", vec3(-0.2f), vec3(0.2f), assets::diffuse(vec3(0.3f, 0.5f, 0.7f)));
    scene.registry().patch<scene::Transform>(box,
                                             [](scene::Transform& place) { place.position = vec3(0.0f, 0.7f, 0.3f); });
    scene::Mover line;
    line.path = scene::MoverPath::line;
    line.travel = vec3(1.0f, 0.0f, 0.0f);
    scene.mover(box, line);
    scene.camera("view", vec3(1.8f, 1.7f, 1.8f), vec3(-0.4f, 0.8f, -0.4f), 65.0f);
}

// What becomes of a system's frame.
enum class Fate {
    drawn,
    stopped,       // the host ends the update, if that takes long
    not_declared,  // update without add_passes
    not_executed,  // the graph is thrown away; the system finds out
    not_submitted, // recorded, but the commands are thrown away; the next frame is told
};

class SystemFrames {
public:
    static constexpr std::uint32_t width = 64, height = 48;

    explicit SystemFrames(void (*make)(assets::SceneBuilder&)) : pipelines_(device(), shaders_) {
        scene::register_components(registry);
        shaders_.add(gpu::sunfleck_render_shaders());
        shaders_.add(gi::shaders());
        submission_ = gpu::Submission::create(device(), 2).value();
        rays_ = raytrace::RayScene::create().value();
        g_buffer_pass_ = render::GBufferPass::create(pipelines_).value();
        load(make);
        camera_ = viewer::find_camera(registry, viewer::scene_bounds(registry, meshes), "view").value();
    }
    ~SystemFrames() { static_cast<void>(device().wait_idle()); }

    // Another scene in place of what there is; the camera stays.
    void load(void (*make)(assets::SceneBuilder&)) {
        for (const ecs::Entity entity : registry.entities())
            registry.destroy(entity);
        assets::SceneBuilder builder(registry, meshes);
        make(builder);
        scene::update_world_transforms(registry);
        EXPECT_TRUE(gpu_scene_.update_meshes(meshes, *submission_));
    }

    // The new system's number.
    std::size_t add(const gi::Settings& settings) {
        Lit lit;
        lit.system = gi::System::create(device(), pipelines_).value();
        EXPECT_TRUE(lit.system->set_settings(settings));
        gpu::ImageDescription image;
        image.name = "picture " + std::to_string(systems_.size());
        image.format = VK_FORMAT_R32G32B32A32_SFLOAT;
        image.width = width;
        image.height = height;
        image.usage = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
        lit.picture = gpu::Image::create(device(), image).value();
        lit.lost_picture = gpu::Image::create(device(), image).value();
        systems_.push_back(std::move(lit));
        return systems_.size() - 1;
    }
    gi::System& system(std::size_t i = 0) { return *systems_[i].system; }

    void frame(std::uint64_t step, Fate fate = Fate::drawn) {
        const Status status = run(step, fate);
        ASSERT_TRUE(status) << status.error().message;
    }
    // Frames at `step` until nothing is left to be done over several of them.
    void settle(std::uint64_t step) {
        for (int i = 0; i < 60; ++i) {
            frame(step);
            double waiting = 0;
            for (Lit& lit : systems_)
                for (const char* counter : {"baked_light_waiting", "refined_light_waiting", "shadow_maps_stale",
                                            "shadow_tiles_stale", "light_samples_behind"})
                    waiting += lit.system->counters()[counter];
            if (waiting == 0)
                return;
        }
        ADD_FAILURE() << "light was not baked in 60 frames";
    }
    std::vector<vec4> picture(std::size_t i = 0) {
        gpu::BufferDescription description;
        description.name = "read-back";
        description.size = std::uint64_t(width) * height * sizeof(vec4);
        description.usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT;
        description.memory = gpu::MemoryUse::readback;
        const gpu::Buffer target = gpu::Buffer::create(device(), description).value();
        EXPECT_TRUE(submission_->immediate([&](VkCommandBuffer commands) -> Status {
            gpu::FrameGraph graph(&device());
            const gpu::ResourceId from = graph.import_image(systems_[i].picture), to = graph.import_buffer(target);
            graph.add_pass("copy")
                .read(from, gpu::Usage::transfer_source)
                .write(to, gpu::Usage::transfer_destination)
                .execute([&](gpu::PassContext& context) -> Status {
                    VkBufferImageCopy region{};
                    region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
                    region.imageExtent = {width, height, 1};
                    context.device.vk.vkCmdCopyImageToBuffer(commands, systems_[i].picture.handle(),
                                                             VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, target.handle(), 1,
                                                             &region);
                    return {};
                });
            graph.add_pass("host").read(to, gpu::Usage::host_read).keep();
            SUNFLECK_TRY(graph.compile());
            gpu::FrameResources unused(device());
            return graph.execute(commands, unused, nullptr);
        }));
        const auto* pixels = reinterpret_cast<const vec4*>(target.mapped());
        return {pixels, pixels + std::size_t(width) * height};
    }

    ecs::Registry registry;
    scene::MeshStore meshes;
    std::uint32_t map_budget = 0xffffffffu; // of the next frames (gi::FrameInput)

private:
    struct Lit {
        std::unique_ptr<gi::System> system;
        gpu::Image picture, lost_picture;
    };

    Status run(std::uint64_t step, Fate fate) {
        SUNFLECK_ASSIGN(const VkCommandBuffer commands, submission_->begin());
        const Status updated = update(step, fate);
        lost_ = fate == Fate::not_submitted;
        if (fate == Fate::stopped) {
            ++lost_serials_;
            return {};
        }
        SUNFLECK_TRY(updated);
        SUNFLECK_ASSIGN(const gpu::UploadSlice camera, resources_.upload_value(camera_row()));
        if (fate == Fate::not_executed || fate == Fate::not_submitted) {
            gpu::FrameGraph thrown_away(&device());
            SUNFLECK_TRY(declare(thrown_away, camera, &Lit::lost_picture));
            SUNFLECK_TRY(thrown_away.compile());
            if (fate == Fate::not_submitted)
                SUNFLECK_TRY(thrown_away.execute(commands, resources_, nullptr));
            resources_.retire(std::move(thrown_away));
        }
        if (fate != Fate::drawn) {
            ++lost_serials_; // a frame's number is used once
            return {};
        }
        graph_.reset();
        SUNFLECK_TRY(declare(graph_, camera, &Lit::picture));
        SUNFLECK_TRY(graph_.compile());
        SUNFLECK_TRY(graph_.execute(commands, resources_, nullptr));
        const std::uint64_t serial = submission_->serial();
        SUNFLECK_TRY(submission_->submit());
        return submission_->wait(serial);
    }
    Status update(std::uint64_t step, Fate fate) {
        SUNFLECK_ASSIGN(const std::uint64_t completed, submission_->completed());
        gi::FrameInput input;
        input.serial = submission_->serial() + lost_serials_;
        input.completed_serial = completed + lost_serials_;
        input.previous_frame_lost = lost_;
        input.map_budget = map_budget;
        if (fate == Fate::stopped)
            input.progress = [](float) { return false; };
        input.view_projection = camera_row().view_projection;
        resources_.begin_frame(input.serial, input.completed_serial);
        simulation::set_movers_to_step(registry, step);
        scene::deform_meshes(registry, meshes);
        const scene::SceneChanges& changes = tracker_.collect(registry, meshes);
        SUNFLECK_TRY(rays_->update(changes, meshes));
        SUNFLECK_TRY(gpu_scene_.update(changes, meshes, resources_));
        for (Lit& lit : systems_)
            SUNFLECK_TRY(lit.system->update(registry, changes, meshes, gpu_scene_, *rays_, input));
        return {};
    }
    shared::CameraRow camera_row() const { return scene::make_camera_row(camera_, width, height); }
    Status declare(gpu::FrameGraph& graph, const gpu::UploadSlice& camera, gpu::Image Lit::*picture) {
        gpu_scene_.add_passes(graph);
        const render::GBuffer g_buffer = g_buffer_pass_.add(graph, gpu_scene_, camera, width, height, false);
        for (Lit& lit : systems_)
            SUNFLECK_TRY(lit.system->add_passes(graph, gpu_scene_,
                                                {g_buffer.depth, g_buffer.normals, g_buffer.surface, width, height},
                                                camera, graph.import_image(lit.*picture)));
        return {};
    }

    scene::ChangeTracker tracker_;
    gpu::ShaderLibrary shaders_;
    gpu::PipelineStore pipelines_;
    std::unique_ptr<gpu::Submission> submission_;
    gpu::FrameResources resources_{device()};
    gpu::FrameGraph graph_{&device()};
    scene::GpuScene gpu_scene_{device()};
    std::unique_ptr<raytrace::RayScene> rays_;
    render::GBufferPass g_buffer_pass_;
    scene::CameraView camera_;
    std::vector<Lit> systems_;
    std::uint64_t lost_serials_ = 0;
    bool lost_ = false;
};

} // namespace sunfleck::tests

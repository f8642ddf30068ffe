// One frame of a foreign host: the CPU's part, and the passes recorded into the host's command buffer.
#include "gi_module/host_context.h"

#include "engine/core/memory_limit.h"
#include "engine/scene/camera_view.h"
#include "gi_module/frame_times.h"

#include <cstring>
#include <unordered_map>

namespace sunfleck::host {
namespace {

scene::CameraView view_of(const Camera& camera) {
    scene::CameraView view;
    view.position = vector_of(camera.position);
    view.target = view.position + vector_of(camera.forward);
    view.up = vector_of(camera.up);
    view.vertical_field_of_view = camera.vertical_field_of_view;
    return view;
}

// Rounded once, at the end: hosts' cameras may be far from the origin.
glm::dmat4 world_to_clip_of(const View& view) {
    glm::dmat4 world_to_view, view_to_clip;
    for (int i = 0; i < 16; ++i) {
        world_to_view[i / 4][i % 4] = double(view.world_to_view[std::size_t(i)]);
        view_to_clip[i / 4][i % 4] = double(view.view_to_clip[std::size_t(i)]);
    }
    if (view.clip_y_up)
        for (int c = 0; c < 4; ++c)
            view_to_clip[c][1] = -view_to_clip[c][1];
    return view_to_clip * world_to_view;
}

} // namespace

void set_memory_limit(std::uint64_t bytes) {
    sunfleck::set_memory_limit(bytes);
}

Matrix4 view_projection(const Camera& camera, std::uint32_t width, std::uint32_t height) {
    if (!check_camera(camera) || width == 0 || height == 0)
        return identity;
    const shared::CameraRow row = scene::make_camera_row(view_of(camera), width, height);
    Matrix4 result;
    std::memcpy(result.data(), &row.view_projection, sizeof result);
    return result;
}

Result<std::unique_ptr<Follower>> Follower::create(gpu::Device& device, gpu::PipelineStore& pipelines,
                                                   const Description& description, const gi::Settings& settings) {
    auto follower = std::make_unique<Follower>(description);
    follower->gpu_scene = std::make_unique<scene::GpuScene>(device);
    SUNFLECK_ASSIGN(follower->rays, raytrace::RayScene::create());
    SUNFLECK_ASSIGN(follower->system, gi::System::create(device, pipelines));
    SUNFLECK_TRY(follower->system->set_settings(settings));
    SUNFLECK_ASSIGN(follower->conversion, gi::GBufferConversion::create(device, pipelines));
    follower->graph = std::make_unique<gpu::FrameGraph>(&device);
    return follower;
}

// Frames in flight may use what the old follower has.
Status Context::Implementation::restart() {
    if (follower != nullptr)
        resources->retire(std::move(follower));
    SUNFLECK_ASSIGN(follower, Follower::create(*device, *pipelines, description, settings));
    damaged = false;
    return {};
}

// What the last frame uploaded and drew never happened on the GPU: buffers and images that it would have filled are
// made again. Frames before it may still use the old ones.
void Context::Implementation::forget_lost_commands() {
    resources->retire(std::move(follower->graph));
    follower->graph = std::make_unique<gpu::FrameGraph>(device.get());
    resources->retire(std::move(follower->gpu_scene));
    follower->gpu_scene = std::make_unique<scene::GpuScene>(*device);
}

Status Context::update(const Frame& frame) {
    Implementation& self = *implementation_;
    return self.run([&]() -> Status {
        SUNFLECK_TRY(self.check_ready());
        SUNFLECK_TRY(self.serials.check(frame));
        if (self.follower != nullptr)
            self.follower->updated = false;
        Status status = guarded(
            self.engine_log, [&] { return self.update(frame); }, "update");
        // One that was stopped, or that lacks a choice of settings, is whole.
        if (!status && status.error().code != ErrorCode::stopped)
            self.damaged = true;
        return status;
    });
}

Status Context::Implementation::update(const Frame& frame) {
    serials.completed = frame.completed_serial;
    if (frame.dropped && serials.recorded == frame.serial)
        --serials.recorded;
    resources->begin_frame(frame.serial, frame.completed_serial);
    SUNFLECK_TRY(timers->begin_frame(frame.serial, frame.completed_serial));
    const bool fresh = damaged || follower == nullptr;
    if (fresh)
        SUNFLECK_TRY(restart());
    else if (frame.dropped)
        forget_lost_commands();
    const bool lost = !fresh && (frame.dropped || follower->unrecorded);
    follower->unrecorded = true;
    bool went_on = true;
    Frame watched = frame;
    if (frame.progress)
        watched.progress = [&](float share) { return went_on = frame.progress(share); };
    if (const Status status = follow(watched, lost); !status)
        return went_on ? status : Status(Error{status.error().message, ErrorCode::stopped});
    number_surfaces();
    drop_removed_meshes();
    follower->updated = true;
    return {};
}

Status Context::Implementation::follow(const Frame& frame, bool lost) {
    Follower& self = *follower;
    const scene::SceneChanges& changes = self.mirror.change_tracker.collect(self.mirror.registry, description.meshes);
    if (changes.space != self.space)
        self.view_projection.reset();
    self.space = changes.space;
    constexpr float until_meshes = 0.1f, until_light = 0.2f; // of the work, where all of it is to be done
    float done = 0.0f;
    const auto part = [&](float end) {
        return frame.progress ? [&, begin = done, end](float share) {
            done = end;
            return frame.progress(begin + (end - begin) * share);
        } : std::function<bool(float)>();
    };
    SUNFLECK_TRY(self.rays->update(changes, description.meshes, &description.textures, part(until_meshes)));
    SUNFLECK_TRY(self.gpu_scene->stage_meshes(description.meshes, *resources, part(until_light)));
    SUNFLECK_TRY(self.gpu_scene->update(changes, description.meshes, *resources));
    gi::FrameInput input;
    input.serial = frame.serial;
    input.completed_serial = frame.completed_serial;
    input.map_budget = frame.map_budget;
    input.refinement_budget = frame.refinement_budget;
    input.progress = part(1.0f);
    input.view_projection = self.view_projection;
    gi::set_measured_times(input, timers->latest());
    input.previous_frame_lost = lost;
    return self.system->update(self.mirror.registry, changes, description.meshes, *self.gpu_scene, *self.rays, input);
}

void Context::Implementation::number_surfaces() {
    std::unordered_map<ecs::Entity, std::uint32_t> rows;
    for (const scene::DrawItem& item : follower->gpu_scene->draws())
        rows[item.entity] = item.row;
    for (auto& [number, instance] : follower->mirror.instances) {
        const auto found = rows.find(instance.entity);
        instance.surface = found == rows.end() ? 0 : found->second + 1;
    }
}

// Nobody refers to them any more. The GPU's copy goes with the next update.
void Context::Implementation::drop_removed_meshes() {
    for (const std::uint32_t mesh : description.removed_meshes)
        description.meshes.remove(mesh);
    description.removed_meshes.clear();
}

std::uint32_t Context::surface_id(std::uint32_t instance) const {
    const Implementation& self = *implementation_;
    const Implementation::Reading reads(self);
    if (!reads.allowed || self.damaged || self.follower == nullptr)
        return 0;
    const Mirror::Instance* known = self.follower->mirror.instances.find(instance);
    return known == nullptr ? 0 : known->surface;
}

Status Context::record(VkCommandBuffer commands, const Camera& camera, const FrameImages& images) {
    Implementation& self = *implementation_;
    return self.run([&]() -> Status {
        SUNFLECK_TRY(self.check_record(commands, images));
        SUNFLECK_TRY(check_camera(camera));
        const scene::SceneSpace& space = self.follower->space;
        const scene::ProjectedCamera projected{scene::make_camera_row(space.view(view_of(camera)), images.width,
                                                                      images.height, scene::camera_near / space.unit),
                                               {}};
        return self.record(commands, projected, images);
    });
}

Status Context::record(VkCommandBuffer commands, const View& view, const FrameImages& images) {
    Implementation& self = *implementation_;
    return self.run([&]() -> Status {
        SUNFLECK_TRY(self.check_record(commands, images));
        SUNFLECK_TRY(check_view(view));
        const auto projected = scene::camera_from_matrix(self.follower->space.to_clip(world_to_clip_of(view)),
                                                         images.width, images.height);
        if (!projected)
            return wrong("View: " + projected.error().message);
        return self.record(commands, *projected, images);
    });
}

// Whatever is refused here leaves the update to be recorded by another call.
Status Context::Implementation::check_record(VkCommandBuffer commands, const FrameImages& images) const {
    SUNFLECK_TRY(check_ready());
    if (damaged || follower == nullptr || !follower->updated)
        return wrong("record needs an update before it, each frame");
    if (commands == VK_NULL_HANDLE)
        return wrong("commands is null; record needs a command buffer");
    return check_images(images, device->traits().max_image_size);
}

Status Context::Implementation::record(VkCommandBuffer commands, const scene::ProjectedCamera& camera,
                                       const FrameImages& images) {
    shared::CameraRow row = camera.row;
    row.previous_view_projection = follower->view_projection.value_or(row.view_projection);
    damaged = true; // until all is recorded
    SUNFLECK_ASSIGN(const gpu::UploadSlice slice, resources->upload_value(row));
    SUNFLECK_TRY(record_passes(commands, slice, camera.depth, images));
    damaged = false;
    follower->updated = follower->unrecorded = false;
    follower->view_projection = row.view_projection;
    serials.recorded = resources->serial();
    return {};
}

Status Context::Implementation::record_passes(VkCommandBuffer commands, const gpu::UploadSlice& row,
                                              const scene::DepthMapping& mapping, const FrameImages& images) {
    gpu::FrameGraph& graph = *follower->graph;
    graph.reset();
    follower->gpu_scene->add_passes(graph);
    const gi::HostGBuffer host = import_g_buffer(graph, images, mapping);
    SUNFLECK_ASSIGN(gi::GBufferInput g_buffer, follower->conversion->add_passes(graph, host, row));
    g_buffer.motion = import_optional(graph, "host motion", images.motion, VK_FORMAT_R16G16_SFLOAT, images);
    g_buffer.metallic_roughness =
        import_optional(graph, "host metallic and roughness", images.metallic_roughness, VK_FORMAT_R8G8_UNORM, images);
    const gpu::ResourceId output = import_output(graph, "host irradiance", images.irradiance, images);
    const gpu::ResourceId specular =
        import_optional(graph, "host specular light", images.specular, VK_FORMAT_R16G16B16A16_SFLOAT, images);
    SUNFLECK_TRY(follower->system->add_passes(graph, *follower->gpu_scene, g_buffer, row, output, specular));
    SUNFLECK_TRY(graph.compile());
    return graph.execute(commands, *resources, timers.get());
}

} // namespace sunfleck::host

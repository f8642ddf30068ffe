// One frame of a foreign host: the CPU's part, and the passes recorded into the host's command buffer.
#include "gi_module/host_context.h"

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

bool is_camera(const Camera& camera) {
    const vec3 forward = vector_of(camera.forward);
    return is_finite(vector_of(camera.position)) && is_finite(forward) && is_finite(vector_of(camera.up)) &&
           glm::length(forward) > 1e-12f && camera.vertical_field_of_view > 0.0f && camera.vertical_field_of_view < pi;
}

} // namespace

Matrix4 view_projection(const Camera& camera, std::uint32_t width, std::uint32_t height) {
    const shared::CameraRow row = scene::make_camera_row(view_of(camera), width, height);
    Matrix4 result;
    std::memcpy(result.data(), &row.view_projection, sizeof result);
    return result;
}

// What the last frame uploaded and drew never happened on the GPU: buffers and images that it would have filled are
// made again. Frames before it may still use the old ones.
void Context::Implementation::forget_lost_commands() {
    resources->retire(std::move(graph));
    graph = std::make_unique<gpu::FrameGraph>(device.get());
    resources->retire(std::move(gpu_scene));
    gpu_scene = std::make_unique<scene::GpuScene>(*device);
}

Status Context::update(const Frame& frame) {
    Implementation& self = *implementation_;
    self.updated = false;
    self.resources->begin_frame(frame.serial, frame.completed_serial);
    self.timers->begin_frame(frame.serial, frame.completed_serial);
    if (frame.dropped || self.broken)
        self.forget_lost_commands();
    const bool lost = frame.dropped || self.broken || self.unrecorded;
    self.broken = false;
    self.unrecorded = true;
    const scene::SceneChanges& changes = self.change_tracker.collect(self.registry, self.meshes);
    if (changes.space != self.space)
        self.view_projection.reset();
    self.space = changes.space;
    SUNFLECK_TRY(self.rays->update(changes, self.meshes, &self.textures));
    SUNFLECK_TRY(self.gpu_scene->stage_meshes(self.meshes, *self.resources));
    SUNFLECK_TRY(self.gpu_scene->update(changes, self.meshes, *self.resources));
    gi::FrameInput input;
    input.serial = frame.serial;
    input.completed_serial = frame.completed_serial;
    input.map_budget = frame.map_budget;
    input.progress = frame.progress;
    input.view_projection = self.view_projection;
    gi::set_measured_times(input, self.timers->latest());
    input.previous_frame_lost = lost;
    SUNFLECK_TRY(self.system->update(self.registry, changes, self.meshes, *self.gpu_scene, *self.rays, input));
    std::unordered_map<ecs::Entity, std::uint32_t> rows;
    for (const scene::DrawItem& item : self.gpu_scene->draws())
        rows[item.entity] = item.row;
    self.surface_ids.assign(self.instances.size(), 0);
    for (std::size_t i = 0; i < self.instances.size(); ++i)
        if (const auto found = rows.find(self.instances[i]); found != rows.end())
            self.surface_ids[i] = found->second + 1;
    self.updated = true;
    return {};
}

std::uint32_t Context::surface_id(std::uint32_t instance) const {
    const auto& ids = implementation_->surface_ids;
    return instance < ids.size() ? ids[instance] : 0;
}

Status Context::record(VkCommandBuffer commands, const Camera& camera, const FrameImages& images) {
    if (!is_camera(camera))
        return Error{"a camera's numbers must be finite, its direction not zero, its field of view between 0 and pi"};
    const scene::SceneSpace& space = implementation_->space;
    const scene::ProjectedCamera projected{scene::make_camera_row(space.view(view_of(camera)), images.width,
                                                                  images.height, scene::camera_near / space.unit),
                                           {}};
    return implementation_->record(commands, projected, images);
}

Status Context::record(VkCommandBuffer commands, const View& view, const FrameImages& images) {
    SUNFLECK_ASSIGN(
        const scene::ProjectedCamera projected,
        scene::camera_from_matrix(implementation_->space.to_clip(world_to_clip_of(view)), images.width, images.height));
    return implementation_->record(commands, projected, images);
}

// Whatever is refused here leaves the update to be recorded by another call.
Status Context::Implementation::record(VkCommandBuffer commands, const scene::ProjectedCamera& camera,
                                       const FrameImages& images) {
    if (!updated)
        return Error{"record needs an update before it, each frame"};
    if (commands == VK_NULL_HANDLE)
        return Error{"record needs a command buffer"};
    SUNFLECK_TRY(check_images(images));
    shared::CameraRow row = camera.row;
    row.previous_view_projection = view_projection.value_or(row.view_projection);
    SUNFLECK_ASSIGN(const gpu::UploadSlice slice, resources->upload_value(row));
    updated = false;
    broken = true; // until all is recorded
    SUNFLECK_TRY(record_passes(commands, slice, camera.depth, images));
    broken = unrecorded = false;
    view_projection = row.view_projection;
    return {};
}

Status Context::Implementation::record_passes(VkCommandBuffer commands, const gpu::UploadSlice& row,
                                              const scene::DepthMapping& mapping, const FrameImages& images) {
    graph->reset();
    gpu_scene->add_passes(*graph);
    const gi::HostGBuffer host = import_g_buffer(*graph, images, mapping);
    SUNFLECK_ASSIGN(gi::GBufferInput g_buffer, conversion->add_passes(*graph, host, row));
    g_buffer.motion = import_optional(*graph, "host motion", images.motion, VK_FORMAT_R16G16_SFLOAT, images);
    g_buffer.metallic_roughness =
        import_optional(*graph, "host metallic and roughness", images.metallic_roughness, VK_FORMAT_R8G8_UNORM, images);
    const gpu::ResourceId output = import_output(*graph, "host irradiance", images.irradiance, images);
    const gpu::ResourceId specular =
        import_optional(*graph, "host specular light", images.specular, VK_FORMAT_R16G16B16A16_SFLOAT, images);
    if (specular.valid())
        SUNFLECK_TRY(conversion->add_clear(*graph, specular));
    SUNFLECK_TRY(system->add_passes(*graph, *gpu_scene, g_buffer, row, output));
    SUNFLECK_TRY(graph->compile());
    return graph->execute(commands, *resources, timers.get());
}

} // namespace sunfleck::host

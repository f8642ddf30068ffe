#include "viewer/scene_renderer.h"

#include "engine/core/memory_limit.h"
#include "engine/ecs/world_copy.h"
#include "engine/io/scene_file.h"
#include "engine/scene/deformation.h"
#include "engine/simulation/path_movers.h"
#include "gi_module/frame_times.h"

namespace sunfleck::gpu {
std::span<const EmbeddedShader> sunfleck_render_shaders();
}

namespace sunfleck::viewer {
namespace {

using Clock = std::chrono::steady_clock;
double milliseconds(Clock::duration duration) {
    return std::chrono::duration<double, std::milli>(duration).count();
}

constexpr const char* waiting = "waiting for the GPU";
constexpr VkFormat display_format = VK_FORMAT_R8G8B8A8_UNORM;
constexpr VkFormat linear_format = VK_FORMAT_R32G32B32A32_SFLOAT;

Status replace_in(gpu::ShaderLibrary& shaders, gpu::PipelineStore& pipelines, const std::string& path,
                  const std::vector<std::uint32_t>& words) {
    SUNFLECK_ASSIGN(const auto before, shaders.find(path));
    std::vector<std::uint32_t> old(before.begin(), before.end());
    SUNFLECK_TRY(shaders.replace(path, words));
    Status status = pipelines.refresh();
    if (!status) // the old pipelines are kept; keep the old shader, too
        SUNFLECK_TRY(shaders.replace(path, std::move(old)));
    return status;
}

} // namespace

Result<std::unique_ptr<SceneRenderer>> SceneRenderer::create(gpu::Device& device, std::uint32_t frames_in_flight) {
    std::unique_ptr<SceneRenderer> renderer(new SceneRenderer(device));
    scene::register_components(renderer->registry_);
    renderer->shaders_ = renderer->lighting_shaders_ = std::make_shared<gpu::ShaderLibrary>();
    renderer->shaders_->add(gpu::sunfleck_render_shaders());
    renderer->shaders_->add(gi::shaders());
    renderer->pipelines_ = renderer->lighting_pipelines_ =
        std::make_shared<gpu::PipelineStore>(device, *renderer->shaders_);
    SUNFLECK_ASSIGN(renderer->submission_, gpu::Submission::create(device, frames_in_flight));
    renderer->resources_ = std::make_unique<gpu::FrameResources>(device);
    renderer->timers_ = std::make_unique<gpu::Timers>(device);
    renderer->graph_ = std::make_unique<gpu::FrameGraph>(&device);
    renderer->gpu_scene_ = std::make_unique<scene::GpuScene>(device);
    SUNFLECK_ASSIGN(renderer->rays_, raytrace::RayScene::create());
    SUNFLECK_ASSIGN(renderer->lighting_, gi::System::create(device, *renderer->pipelines_));
    SUNFLECK_ASSIGN(renderer->g_buffer_pass_, render::GBufferPass::create(*renderer->pipelines_));
    SUNFLECK_ASSIGN(renderer->composition_,
                    render::CompositionPass::create(device, *renderer->pipelines_, display_format));
    renderer->sky_ = std::make_unique<render::SkyImage>(device);
    SUNFLECK_ASSIGN(renderer->meter_, render::ExposureMeter::create(device, *renderer->pipelines_));
    SUNFLECK_ASSIGN(renderer->stipple_, render::StipplePass::create(device, *renderer->pipelines_));
    SUNFLECK_ASSIGN(renderer->glare_, render::GlarePass::create(device, *renderer->pipelines_));
    SUNFLECK_ASSIGN(renderer->antialiasing_, render::AntialiasingPass::create(*renderer->pipelines_));
    SUNFLECK_ASSIGN(renderer->subpixel_edges_, render::SubpixelEdges::create(device, *renderer->pipelines_));
    SUNFLECK_ASSIGN(renderer->upscale_, render::UpscalePass::create(*renderer->pipelines_));
    SUNFLECK_ASSIGN(renderer->temporal_, render::TemporalEnlargement::create(device, *renderer->pipelines_));
    SUNFLECK_ASSIGN(auto lines, render::DebugLines::create(*renderer->pipelines_, display_format));
    renderer->debug_lines_ = std::make_unique<render::DebugLines>(std::move(lines));
    return renderer;
}

SceneRenderer::~SceneRenderer() {
    if (submission_) // the queue itself may be at work for others
        static_cast<void>(submission_->wait(submission_->serial() - 1));
    composition_.destroy(device_);
    glare_.destroy(device_);
    stipple_.destroy(device_);
}

Result<io::ImportReport> SceneRenderer::load(const std::filesystem::path& path, const io::ImportOptions& options,
                                             const std::function<Status(ecs::Registry&)>& modify) {
    // Which takes longer, reading the file or preparing its meshes, cannot be told beforehand.
    const auto half_of_progress = [&](float begin) -> std::function<bool(float)> {
        if (!options.progress)
            return {};
        return [&options, begin](float share) { return options.progress(begin + 0.5f * share); };
    };
    io::ImportOptions reading = options;
    reading.progress = half_of_progress(0.0f);
    SUNFLECK_ASSIGN(io::ImportReport report, io::load_scene(path, registry_, meshes_, textures_, reading));
    if (modify)
        SUNFLECK_TRY(modify(registry_));
    if (report.default_light && add_default_light(registry_))
        report.notes.push_back("the scene has no lights: lit by the default sky and sun");
    SUNFLECK_TRY(upload_meshes(half_of_progress(0.5f)));
    return report;
}

Status SceneRenderer::upload_meshes(const std::function<bool(float)>& progress) {
    const scene::EnvironmentImage* picture = nullptr;
    registry_.view<scene::EnvironmentMap>().each(
        [&](ecs::Entity, const scene::EnvironmentMap& map) { picture = map.image.get(); });
    SUNFLECK_TRY(sky_->update(picture, *submission_));
    SUNFLECK_TRY(gpu_scene_->update_textures(textures_, *submission_));
    return gpu_scene_->update_meshes(meshes_, *submission_, progress);
}

std::unique_ptr<SceneCopy> SceneRenderer::copy_scene(CopyOf what) {
    auto copy = std::make_unique<SceneCopy>();
    ecs::copy_world(registry_, copy->registry);
    if (what == CopyOf::all) {
        copy->meshes = meshes_;
        copy->textures = textures_;
    }
    return copy;
}

Status SceneRenderer::take_scene(std::unique_ptr<SceneCopy> copy) {
    ecs::copy_world(copy->registry, registry_);
    if (meshes_.size() > 0)
        return {};
    meshes_ = std::move(copy->meshes);
    textures_ = std::move(copy->textures);
    return upload_meshes();
}

void SceneRenderer::exchange_lighting(SceneRenderer& other) {
    std::swap(gpu_scene_, other.gpu_scene_);
    std::swap(rays_, other.rays_);
    std::swap(geometry_outdated_, other.geometry_outdated_);
    std::swap(lighting_, other.lighting_);
    std::swap(lighting_shaders_, other.lighting_shaders_);
    std::swap(lighting_pipelines_, other.lighting_pipelines_);
    previous_request_.ev100 = std::numeric_limits<float>::quiet_NaN(); // like no other
    rays_->continue_with(meshes_, &textures_);
    other.rays_->continue_with(other.meshes_, &other.textures_);
}

Status SceneRenderer::update(const FrameRequest& request) {
    stages_.clear();
    frame_start_ = Clock::now();
    {
        const StageTimer timer(stages_, "simulation");
        if (request.simulate)
            simulation::set_movers_to_step(registry_, request.step);
    }
    SUNFLECK_ASSIGN(const std::uint64_t completed, submission_->completed());
    resources_->begin_frame(submission_->serial(), completed);
    SUNFLECK_TRY(timers_->begin_frame(submission_->serial(), completed));
    const scene::SceneChanges* changes = nullptr;
    {
        const StageTimer timer(stages_, "scene changes");
        scene::deform_meshes(registry_, meshes_);
        changes = &change_tracker_.collect(registry_, meshes_);
        has_previous_camera_ = has_previous_camera_ && changes->space == space_;
        space_ = changes->space;
        scene_changed_ = changes->everything || changes->order_changed || changes->static_geometry ||
                         !changes->drawables.empty() || !changes->meshes.empty() || changes->emitters_changed();
    }
    SUNFLECK_TRY(update_rays(request, *changes));
    {
        const StageTimer timer(stages_, "gpu scene");
        SUNFLECK_TRY(gpu_scene_->update(*changes, meshes_, *resources_));
    }
    return update_lighting(request, *changes, completed);
}

Status SceneRenderer::update_rays(const FrameRequest& request, const scene::SceneChanges& changes) {
    const StageTimer timer(stages_, "ray scene");
    geometry_outdated_ = request.keep_samples && request.keep_geometry && !changes.everything &&
                         (geometry_outdated_ || changes.static_geometry);
    return geometry_outdated_ ? Status() : rays_->update(changes, meshes_, &textures_);
}

Status SceneRenderer::update_lighting(const FrameRequest& request, const scene::SceneChanges& changes,
                                      std::uint64_t completed) {
    const StageTimer timer(stages_, "lighting");
    gi::FrameInput input;
    input.serial = submission_->serial();
    input.completed_serial = completed;
    input.map_budget = request.map_budget;
    input.light_pixels = request.light_pixels;
    input.as_if_stale = request.as_if_stale;
    input.view = request.lighting_view;
    gi::set_measured_times(input, timers_->latest());
    input.progress = request.progress;
    input.indirect_scale = request.indirect_scale;
    input.strength_budget = request.strength_budget;
    input.refinement_budget = request.refinement_budget;
    input.milliseconds = request.milliseconds;
    input.keep_samples = request.keep_samples;
    input.view_projection = camera_row(request).view_projection;
    return lighting_->update(registry_, changes, meshes_, *gpu_scene_, *rays_, input);
}

shared::CameraRow SceneRenderer::camera_row(const FrameRequest& request) const {
    return scene::make_camera_row(space_.view(request.camera), request.width, request.height);
}

// G-buffer (20 bytes a pixel), light (8, and what techniques keep at full and at low resolution), picture, and the
// picture on its way to a file (16): 75 to 95 bytes a pixel were measured.
Status SceneRenderer::check_size(std::uint32_t width, std::uint32_t height) {
    constexpr std::uint64_t bytes_per_pixel = 100;
    return check_memory(bytes_per_pixel * width * height,
                        "a picture of " + std::to_string(width) + "x" + std::to_string(height), "--size");
}

Status SceneRenderer::make_output(const FrameRequest& request) {
    const VkFormat format = request.tone_map ? display_format : linear_format;
    const gpu::ImageDescription& has = output_.description();
    const bool enlarged = request.is_enlarged();
    const std::uint32_t width = enlarged ? request.screen_width : request.width;
    const std::uint32_t height = enlarged ? request.screen_height : request.height;
    if (output_ && has.width == width && has.height == height && has.format == format)
        return {};
    SUNFLECK_TRY(check_size(width, height));
    if (output_)
        resources_->retire(std::move(output_));
    gpu::ImageDescription description;
    description.name = "picture";
    description.format = format;
    description.width = width;
    description.height = height;
    description.usage = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT |
                        VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT;
    SUNFLECK_ASSIGN(output_, gpu::Image::create(device_, description));
    return {};
}

// As the G-buffer sees it. Without temporal anti-aliasing, each pixel is sampled in its middle.
shared::CameraRow SceneRenderer::camera_of_frame(const FrameRequest& request) {
    shared::CameraRow camera = camera_row(request);
    if (has_previous_camera_)
        camera.previous_view_projection = previous_camera_.view_projection;
    camera_moves_ = !has_previous_camera_ || camera.previous_view_projection != camera.view_projection;
    previous_camera_ = camera;
    has_previous_camera_ = true;
    temporal_frame_ = request.may_be_temporal() && !is_cut(request);
    if (temporal_frame_)
        render::TemporalEnlargement::apply_offset(camera, temporal_->offset());
    else
        temporal_->forget();
    return camera;
}

Status SceneRenderer::record(VkCommandBuffer commands, const FrameRequest& request, const Overlay& overlay) {
    const StageTimer timer(stages_, "recording");
    if (request.picture) {
        SUNFLECK_TRY(make_output(request));
        SUNFLECK_TRY(draw_lines(request));
    }
    SUNFLECK_ASSIGN(const gpu::UploadSlice camera_slice, resources_->upload_value(camera_of_frame(request)));

    graph_->reset();
    gpu_scene_->add_passes(*graph_);
    const render::GBuffer g_buffer =
        g_buffer_pass_.add(*graph_, *gpu_scene_, camera_slice, request.width, request.height,
                           request.view == shared::view_motion || temporal_frame_ || compiles_temporal(request));
    SUNFLECK_ASSIGN(const Light light, add_lighting(request, g_buffer, camera_slice));
    if (request.picture) {
        const gpu::ResourceId output = graph_->import_image(output_);
        SUNFLECK_TRY(add_picture(request, g_buffer, light, camera_slice, output));
        if (overlay)
            SUNFLECK_TRY(overlay(*graph_, output, *resources_));
        graph_->add_pass("hand over").read(output, gpu::Usage::transfer_source).keep();
    } else if (request.light_pixels) {
        graph_->mark_output(light.irradiance);
        if (light.specular.valid())
            graph_->mark_output(light.specular);
    }
    SUNFLECK_TRY(graph_->compile());
    return graph_->execute(commands, *resources_, timers_.get());
}

Status SceneRenderer::render_and_wait(const FrameRequest& request) {
    const auto start = Clock::now();
    SUNFLECK_TRY(update(request));
    SUNFLECK_ASSIGN(const VkCommandBuffer commands, submission_->begin());
    passes_.reset();
    if (request.passes_done) {
        SUNFLECK_ASSIGN(passes_, gpu::PassProgress::create(device_));
    }
    graph_->set_progress(passes_ ? &*passes_ : nullptr);
    const Status recorded = record(commands, request);
    graph_->set_progress(nullptr);
    SUNFLECK_TRY(recorded);
    SUNFLECK_TRY(submission_->submit());
    {
        const StageTimer timer(stages_, waiting);
        SUNFLECK_TRY(wait_for_newest(request));
    }
    statistics_.frame_ms = milliseconds(Clock::now() - start);
    return collect_statistics();
}

Status SceneRenderer::wait_for_newest(const FrameRequest& request) const {
    using namespace std::chrono_literals;
    const std::uint64_t serial = submission_->serial() - 1;
    if (!passes_)
        return submission_->wait(serial);
    for (std::chrono::nanoseconds time = 1s;; time = 100ms) {
        SUNFLECK_ASSIGN(const bool done, submission_->wait_for(serial, time));
        if (done)
            return {};
        request.passes_done(passes_->share_done());
    }
}

Status SceneRenderer::collect_statistics() {
    if (const auto completed = submission_->completed())
        SUNFLECK_TRY(timers_->collect(*completed));
    std::vector<StageScope> scopes = stages_.scopes();
    const std::vector<StageScope>& of_lighting = lighting_->cpu_times().scopes();
    scopes.insert(scopes.end(), of_lighting.begin(), of_lighting.end());
    sort_by_begin(scopes);
    statistics_.cpu_scopes.clear();
    for (const StageScope& scope : scopes)
        statistics_.cpu_scopes.push_back(
            {scope.name, milliseconds(scope.begin - frame_start_), milliseconds(scope.end - frame_start_)});
    statistics_.cpu_ms = own_milliseconds(std::move(scopes));
    statistics_.cpu_ms.erase(waiting); // the passes' time, not the CPU's
    statistics_.gpu_ms = timers_->latest().milliseconds;
    statistics_.gpu_scopes = timers_->latest().scopes;
    statistics_.counters = lighting_->counters();
    return {};
}

Result<io::Picture> SceneRenderer::read_back() {
    if (!output_)
        return Error{"nothing has been rendered"};
    const gpu::ImageDescription& description = output_.description();
    const bool linear = description.format == linear_format;
    const std::size_t pixels = std::size_t(description.width) * description.height;
    gpu::BufferDescription staging;
    staging.name = "read-back";
    staging.size = pixels * (linear ? 16 : 4);
    staging.usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT;
    staging.memory = gpu::MemoryUse::readback;
    SUNFLECK_ASSIGN(const gpu::Buffer buffer, gpu::Buffer::create(device_, staging));
    SUNFLECK_TRY(submission_->immediate([&](VkCommandBuffer commands) -> Status {
        gpu::FrameGraph graph(&device_);
        const gpu::ResourceId source = graph.import_image(output_);
        const gpu::ResourceId target = graph.import_buffer(buffer);
        graph.add_pass("read-back")
            .read(source, gpu::Usage::transfer_source)
            .write(target, gpu::Usage::transfer_destination)
            .execute([&](gpu::PassContext& context) -> Status {
                VkBufferImageCopy region{};
                region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
                region.imageExtent = {description.width, description.height, 1};
                context.device.vk.vkCmdCopyImageToBuffer(context.commands, output_.handle(),
                                                         VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, buffer.handle(), 1,
                                                         &region);
                return {};
            });
        graph.add_pass("to host").read(target, gpu::Usage::host_read).keep();
        SUNFLECK_TRY(graph.compile());
        gpu::FrameResources unused(device_);
        return graph.execute(commands, unused, nullptr);
    }));
    io::Picture picture;
    picture.width = description.width;
    picture.height = description.height;
    picture.pixels.resize(pixels);
    if (linear) {
        std::memcpy(picture.pixels.data(), buffer.mapped(), pixels * sizeof(vec4));
        return picture;
    }
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(buffer.mapped());
    for (std::size_t i = 0; i < pixels; ++i)
        for (int c = 0; c < 4; ++c)
            picture.pixels[i][c] = float(bytes[i * 4 + std::size_t(c)]) / 255.0f;
    return picture;
}

std::vector<std::string> SceneRenderer::shader_paths() {
    gpu::ShaderLibrary all;
    all.add(gpu::sunfleck_render_shaders());
    all.add(gi::shaders());
    return all.paths();
}

Status SceneRenderer::replace_shader(const std::string& path, const std::vector<std::uint32_t>& words) {
    SUNFLECK_TRY(device_.wait_idle());
    SUNFLECK_TRY(replace_in(*shaders_, *pipelines_, path, words));
    if (lighting_shaders_ == shaders_)
        return {};
    return replace_in(*lighting_shaders_, *lighting_pipelines_, path, words);
}

} // namespace sunfleck::viewer

// One path from scene to picture: simulation step, world transforms, ray scene, lighting, G-buffer, composition.
#pragma once

#include "engine/gpu/submission.h"
#include "engine/io/image.h"
#include "engine/io/scene_file.h"
#include "engine/render/composition.h"
#include "engine/render/debug_lines.h"
#include "engine/render/upscale.h"
#include "gi_module/system.h"

#include <filesystem>
#include <functional>

namespace sunfleck::viewer {

struct FrameRequest {
    scene::CameraView camera;
    std::uint32_t width = 640, height = 360;
    // Of output(), if they differ from the size that is rendered: the picture is enlarged (tone-mapped pictures only).
    std::uint32_t screen_width = 0, screen_height = 0;
    bool simulate = true; // false: the caller has moved everything
    std::uint32_t view = shared::view_final;
    bool tone_map = true;      // false: scene-linear floats, for EXR
    std::uint32_t show = 0;    // false colours of the lighting (gi::FrameInput::show); with view_false_colours
    bool show_samples = false; // debug lines at the light samples
    float ev100 = 8.0f;
    std::uint64_t step = 0; // simulation step that the movers show
    std::uint32_t map_budget = 0xffffffffu;
    float indirect_scale = 1.0f; // of reflected light
    // gi::FrameInput::progress
    std::function<bool(float)> progress;
};

struct FrameStatistics {
    double frame_ms = 0; // from the start of simulation to the end of the GPU's work; only of render_and_wait
    std::map<std::string, double> cpu_ms, gpu_ms;
    gi::Counters counters;
};

class SceneRenderer {
public:
    // The device must outlive the renderer.
    static Result<std::unique_ptr<SceneRenderer>> create(gpu::Device& device, std::uint32_t frames_in_flight = 2);
    ~SceneRenderer();

    ecs::Registry& registry() { return registry_; }
    scene::MeshStore& meshes() { return meshes_; }
    scene::TextureStore& textures() { return textures_; }
    raytrace::RayScene& rays() { return *rays_; }
    gi::System& lighting() { return *lighting_; }
    gpu::Submission& submission() { return *submission_; }
    gpu::ShaderLibrary& shader_library() { return *shaders_; }
    gpu::PipelineStore& pipelines() { return *pipelines_; }
    const scene::GpuScene& gpu_scene() const { return *gpu_scene_; }

    // Loads a scene into the (empty) registry. A scene without any light gets the default light: a sky of
    // 0.3 W/(sr m2) and a sun of 2 W/m2 from above. `amend` may change it before that.
    Result<io::ImportReport> load(const std::filesystem::path& path, const io::ImportOptions& options = {},
                                  const std::function<Status(ecs::Registry&)>& amend = {});
    // Uploads meshes and textures that were added to the store. Waits for the GPU.
    Status upload_meshes();

    // Brings movers, transforms, rays and lighting to `request.step` (CPU work of a frame).
    Status update(const FrameRequest& request);
    // Records the frame into `commands`, after update. The picture is output() afterwards, in the state that a copy
    // reads from. `overlay` may add passes that draw over it.
    using Overlay = std::function<Status(gpu::FrameGraph&, gpu::ResourceId target, gpu::FrameResources&)>;
    Status record(VkCommandBuffer commands, const FrameRequest& request, const Overlay& overlay = {});
    const gpu::Image& output() const { return output_; }

    // update, record, submit and wait; fills statistics.
    Status render_and_wait(const FrameRequest& request);
    Result<io::Picture> read_back();
    const FrameStatistics& statistics() const { return statistics_; }
    // The frame graph of the last frame, as text.
    std::string print_graph() const { return graph_->print(); }
    // After a submission that was not waited for: the statistics of the newest frame that is complete.
    void collect_statistics();

    // Takes newer SPIR-V for one shader. On failure everything stays as it was.
    Status replace_shader(const std::string& path, std::vector<std::uint32_t> words);

private:
    explicit SceneRenderer(gpu::Device& device) : device_(device) {}
    Status make_output(const FrameRequest& request);
    void draw_samples();

    gpu::Device& device_;
    ecs::Registry registry_;
    scene::MeshStore meshes_;
    scene::TextureStore textures_;
    scene::ChangeTracker change_tracker_;
    std::unique_ptr<gpu::ShaderLibrary> shaders_;
    std::unique_ptr<gpu::PipelineStore> pipelines_;
    std::unique_ptr<gpu::Submission> submission_;
    std::unique_ptr<gpu::FrameResources> resources_;
    std::unique_ptr<gpu::Timers> timers_;
    std::unique_ptr<gpu::FrameGraph> graph_;
    std::unique_ptr<scene::GpuScene> gpu_scene_;
    std::unique_ptr<raytrace::RayScene> rays_;
    std::unique_ptr<gi::System> lighting_;
    render::GBufferPass g_buffer_pass_;
    render::CompositionPass composition_;
    std::unique_ptr<render::SkyImage> sky_;
    render::UpscalePass upscale_;
    std::unique_ptr<render::DebugLines> debug_lines_;
    gpu::Image output_;
    shared::CameraRow previous_camera_{};
    bool has_previous_camera_ = false;
    FrameStatistics statistics_;
};

// Named camera, its number, or "px,py,pz,tx,ty,tz,fov" with the field of view in degrees; empty: the camera called
// "view", else the first, else one that sees the whole scene.
Result<scene::CameraView> find_camera(ecs::Registry& registry, const Bounds& bounds, const std::string& wanted);

// EV100 of the scene, or a default.
float scene_exposure(ecs::Registry& registry);

// Bounds of all mesh instances in world space.
Bounds scene_bounds(ecs::Registry& registry, const scene::MeshStore& meshes);

// Adds the default light if the registry has none; true if it did.
bool add_default_light(ecs::Registry& registry);

} // namespace sunfleck::viewer

// The pipeline from scene to image: simulation step, world transforms, ray scene, lighting, G-buffer, composition.
#pragma once

#include "engine/gpu/submission.h"
#include "engine/io/image.h"
#include "engine/io/scene_file.h"
#include "engine/render/antialiasing.h"
#include "engine/render/composition.h"
#include "engine/render/debug_lines.h"
#include "engine/render/exposure_meter.h"
#include "engine/render/glare.h"
#include "engine/render/stipple.h"
#include "engine/render/subpixel_edges.h"
#include "engine/render/temporal_enlargement.h"
#include "engine/render/upscale.h"
#include "gi_module/system.h"

#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>

namespace sunfleck::viewer {

struct FrameRequest {
    scene::CameraView camera;
    std::uint32_t width = 640, height = 360;
    // Size of output() if it differs from the rendered size: the image is upscaled (tone-mapped images only).
    std::uint32_t screen_width = 0, screen_height = 0;
    bool simulate = true; // false: the caller has moved everything already
    std::uint32_t view = shared::view_final;
    bool tone_map = true;              // false: scene-linear floats, for EXR
    bool antialiasing = false;         // PictureSettings; of the final picture with tone_map
    bool temporal = false;             // with it: also from frame to frame, while the camera stands still
    float glare = 0.0f;                // the same
    std::string lighting_view;         // debug view of the lighting by name (gi::debug_views()), in place of irradiance
    bool meter = false;                // measures the picture, for SceneRenderer::metered_exposure
    bool show_samples = false;         // debug lines at the light samples
    std::vector<std::string> overlays; // overlays.h, by name; of tone-mapped pictures
    std::optional<std::uint32_t> overlay_sample; // the light sample that overlays single out
    float ev100 = 8.0f;
    std::uint64_t step = 0; // simulation step of the movers
    std::uint32_t map_budget = 0xffffffffu;
    float indirect_scale = 1.0f;                   // scales indirect light
    std::uint32_t strength_budget = 0xffffffffu;   // gi::FrameInput::strength_budget
    std::uint32_t refinement_budget = 0xffffffffu; // gi::FrameInput::refinement_budget
    std::optional<double> milliseconds;            // gi::FrameInput::milliseconds
    bool picture = true;                           // false: nothing is made but light, output() stays as it is
    bool light_pixels = true;                      // gi::FrameInput::light_pixels
    bool as_if_stale = false;                      // gi::FrameInput::as_if_stale
    bool keep_samples = false;                     // gi::FrameInput::keep_samples
    // Rays and shadows of static geometry stay as they are while that changes, which costs such frames next to nothing:
    // light falls as if it stood where it was. The first frame without this follows. Needs keep_samples.
    bool keep_geometry = false;
    // gi::FrameInput::progress
    std::function<bool(float)> progress;
    // Called by render_and_wait while it waits, from a second on, with the share of the passes that the GPU has done.
    std::function<void(double)> passes_done;

    bool is_enlarged() const;     // the screen's size is not that of the picture
    bool may_be_temporal() const; // made from frame to frame, if the camera stands still
};

struct FrameStatistics {
    double frame_ms = 0; // from the start of simulation to the end of GPU work; only set by render_and_wait
    // A stage's time on the CPU is its own: what lies in it is a stage of its own. Waiting for the GPU is none.
    std::map<std::string, double> cpu_ms, gpu_ms;
    // When, not only how long, and waiting, too; a scope before those within it. On the CPU: ms from the start of
    // simulation; on the GPU: from the start of its first pass.
    std::vector<gpu::ScopeTime> cpu_scopes, gpu_scopes;
    gi::Report counters;
};

// A scene's content, apart from what the GPU and ray tracing have made of it.
struct SceneCopy {
    ecs::Registry registry;
    scene::MeshStore meshes;
    scene::TextureStore textures;
};

class SceneRenderer {
public:
    // The device must outlive the renderer.
    static Result<std::unique_ptr<SceneRenderer>> create(gpu::Device& device, std::uint32_t frames_in_flight = 2);
    ~SceneRenderer();
    // An error if the images of such a picture would be over the limit of memory.
    static Status check_size(std::uint32_t width, std::uint32_t height);

    ecs::Registry& registry() { return registry_; }
    scene::MeshStore& meshes() { return meshes_; }
    scene::TextureStore& textures() { return textures_; }
    raytrace::RayScene& rays() { return *rays_; }
    gi::System& lighting() { return *lighting_; }
    gpu::Submission& submission() { return *submission_; }
    gpu::ShaderLibrary& shader_library() { return *shaders_; }
    gpu::PipelineStore& pipelines() { return *pipelines_; }
    const scene::GpuScene& gpu_scene() const { return *gpu_scene_; }
    // The last update left static geometry as it was (FrameRequest::keep_geometry).
    bool geometry_outdated() const { return geometry_outdated_; }
    // Where the GPU scene, the ray scene and light samples lie since the last update.
    const scene::SceneSpace& space() const { return space_; }

    // Loads a scene into the (empty) registry. A scene without any light gets the default lighting: a sky of
    // 0.3 W/(sr m2) and a sun of 2 W/m2 from above. `modify` may change the scene before that.
    Result<io::ImportReport> load(const std::filesystem::path& path, const io::ImportOptions& options = {},
                                  const std::function<Status(ecs::Registry&)>& modify = {});
    // Uploads meshes and textures that were added to the stores. Waits for the GPU.
    Status upload_meshes(const std::function<bool(float)>& progress = {});

    // For lighting that is made beside the frames (lighting_change.h). A copy of the scene as it is now; `world`: of
    // its entities alone.
    enum class CopyOf { all, world };
    std::unique_ptr<SceneCopy> copy_scene(CopyOf what);
    // Makes this scene one's own: all of it and its uploads, if there was none, and else what has moved or changed
    // since the copy before. Waits for the GPU.
    Status take_scene(std::unique_ptr<SceneCopy> copy);
    // What GPU, ray tracing and lighting have made of the scenes changes places; `other` has a copy of this one's
    // scene, and its frames are finished. This one's must be, before `other` draws again or ends.
    void exchange_lighting(SceneRenderer& other);

    // Updates movers, transforms, ray scene and lighting to `request.step` (a frame's CPU work).
    Status update(const FrameRequest& request);
    // Records the frame into `commands`, after update. The result is output(), in copy-source state. `overlay` may add
    // passes that draw over it.
    using Overlay = std::function<Status(gpu::FrameGraph&, gpu::ResourceId target, gpu::FrameResources&)>;
    Status record(VkCommandBuffer commands, const FrameRequest& request, const Overlay& overlay = {});
    const gpu::Image& output() const { return output_; }
    // Of the last picture.
    const FrameRequest& shown_request() const { return previous_request_; }

    // update, record, submit and wait; fills the statistics.
    Status render_and_wait(const FrameRequest& request);
    Result<io::Picture> read_back();
    const FrameStatistics& statistics() const { return statistics_; }
    // The last frame's graph as text.
    std::string print_graph() const { return graph_->print(); }
    // EV100 that a light meter says of the newest finished frame with FrameRequest::meter, without waiting; none: the
    // last call had it, or there is none.
    std::optional<float> metered_exposure();
    // Without waiting: the statistics of the newest completed frame.
    Status collect_statistics();

    // Of all shaders, from the project's root.
    static std::vector<std::string> shader_paths();
    // Replaces one shader's SPIR-V. On failure nothing changes.
    Status replace_shader(const std::string& path, const std::vector<std::uint32_t>& words);

private:
    explicit SceneRenderer(gpu::Device& device) : device_(device) {}
    Status make_output(const FrameRequest& request);
    Status update_rays(const FrameRequest& request, const scene::SceneChanges& changes);
    Status update_lighting(const FrameRequest& request, const scene::SceneChanges& changes, std::uint64_t completed);
    // From the light to output(): composition, anti-aliasing, enlargement.
    struct Light {
        gpu::ResourceId irradiance, specular; // no specular light: not valid
    };
    Result<Light> add_lighting(const FrameRequest& request, const render::GBuffer& g_buffer,
                               const gpu::UploadSlice& camera);
    Status add_picture(const FrameRequest& request, const render::GBuffer& g_buffer, const Light& light,
                       const gpu::UploadSlice& camera, gpu::ResourceId output);
    // The last submission; tells request.passes_done meanwhile.
    Status wait_for_newest(const FrameRequest& request) const;
    void draw_samples();
    Status draw_lines(const FrameRequest& request);
    shared::CameraRow camera_row(const FrameRequest& request) const;

    gpu::Device& device_;
    ecs::Registry registry_;
    scene::MeshStore meshes_;
    scene::TextureStore textures_;
    scene::ChangeTracker change_tracker_{scene::ChangeTracker::Space::of_scene};
    scene::SceneSpace space_; // of the last update
    bool geometry_outdated_ = false;
    std::shared_ptr<gpu::ShaderLibrary> shaders_;
    std::shared_ptr<gpu::PipelineStore> pipelines_;
    std::shared_ptr<gpu::ShaderLibrary> lighting_shaders_; // of lighting_pipelines_, which lighting_ was made with
    std::shared_ptr<gpu::PipelineStore> lighting_pipelines_;
    std::unique_ptr<gpu::Submission> submission_;
    std::unique_ptr<gpu::FrameResources> resources_;
    std::unique_ptr<gpu::Timers> timers_;
    std::optional<gpu::PassProgress> passes_; // of the frame that was recorded last, if somebody wants to know
    std::unique_ptr<gpu::FrameGraph> graph_;
    std::unique_ptr<scene::GpuScene> gpu_scene_;
    std::unique_ptr<raytrace::RayScene> rays_;
    std::unique_ptr<gi::System> lighting_;
    render::GBufferPass g_buffer_pass_;
    render::CompositionPass composition_;
    std::unique_ptr<render::SkyImage> sky_;
    std::unique_ptr<render::ExposureMeter> meter_;
    render::GlarePass glare_;
    render::StipplePass stipple_;
    render::AntialiasingPass antialiasing_;
    std::unique_ptr<render::SubpixelEdges> subpixel_edges_;
    render::UpscalePass upscale_;
    std::unique_ptr<render::TemporalEnlargement> temporal_;
    std::unique_ptr<render::DebugLines> debug_lines_;
    gpu::Image output_;
    shared::CameraRow camera_of_frame(const FrameRequest& request);
    shared::CameraRow previous_camera_{};
    bool camera_moves_ = true; // since the frame before
    bool temporal_frame_ = false;
    bool temporal_compiled_ = false; // its kernels have run
    // The frame before tells little of this one: the camera or the exposure has moved, or light was switched.
    bool is_cut(const FrameRequest& request) const;
    // Some drivers compile a kernel only when it first runs: that is done with the first picture, not when the camera
    // first stands still.
    bool compiles_temporal(const FrameRequest& request) const {
        return request.may_be_temporal() && !temporal_compiled_;
    }
    // Anything that the picture shows is not what it was; light that is still being made counts.
    bool picture_changes() const;
    bool scene_changed_ = true;
    FrameRequest previous_request_;
    gi::Settings previous_settings_;
    bool has_previous_camera_ = false;
    FrameStatistics statistics_;
    std::chrono::steady_clock::time_point frame_start_;
    StageTimes stages_;
};

// A camera by name or number, or "px,py,pz,tx,ty,tz,fov" with the field of view in degrees; empty: the camera called
// "view", else the first, else one that sees the whole scene.
Result<scene::CameraView> find_camera(ecs::Registry& registry, const Bounds& bounds, const std::string& wanted);

// Bounds of all mesh instances in world space.
Bounds scene_bounds(ecs::Registry& registry, const scene::MeshStore& meshes);

// Adds the default light if nothing in the registry emits any; true if it did.
bool add_default_light(ecs::Registry& registry);

} // namespace sunfleck::viewer

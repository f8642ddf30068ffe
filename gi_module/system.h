// sunfleck::gi::System: global illumination for one scene.
//
// Minimal loop of a host that uses the engine's frame graph:
//
//     auto system = gi::System::create(device, pipelines).value();
//     each frame:
//         changes = tracker.collect(registry, meshes)                       // what moved; rays and GPU scene follow it
//         system->update(registry, changes, meshes, gpu_scene, rays, input) // CPU: samples, visibility, stale maps
//         graph.reset();  ... the host's geometry pass ...
//         irradiance = system->add_passes(graph, gpu_scene, g_buffer, camera)  // declares the GPU work
//         graph.compile();  graph.execute(commands, resources, timers);
//
// The system conducts: it keeps what techniques share (samples, shadow maps, visibility) and asks each technique of the
// light plan for its part. It never submits, waits, presents or owns a swapchain, and no frame waits for a read-back.
// It must be used from one thread at a time; update itself runs on all cores. The device, registry, meshes and GPU
// scene are the host's and must outlive it. Frames are identified by serials that rise by one; resources of a frame are
// reused when `completed_serial` has reached it. Several systems may light one registry.
#pragma once

#include "gi_module/light_composer.h"
#include "gi_module/visibility/scene_visibility.h"

namespace sunfleck::gi {

// The module's embedded shaders, to be added to the host's ShaderLibrary before System::create.
std::vector<gpu::EmbeddedShader> shaders();

class System {
public:
    static Result<std::unique_ptr<System>> create(gpu::Device& device, gpu::PipelineStore& pipelines);
    ~System();

    // Takes effect at the next update. Rejects values outside their described ranges, and light plans without sense.
    Status set_settings(const Settings& settings);
    const Settings& settings() const { return settings_; }

    // Follows the registry: light samples are made when settings, emitters or static geometry changed; maps that a
    // moved object may touch become stale. World transforms, ray scene and GPU scene must be up to date.
    Status update(ecs::Registry& registry, const scene::SceneChanges& changes, const scene::MeshStore& meshes,
                  const scene::GpuScene& gpu_scene, const raytrace::RayScene& rays, const FrameInput& input);

    // Declares this frame's GPU work and returns the irradiance image, RGBA, W/m2 without albedo; alpha 0 where nothing
    // is. `camera` holds a CameraRow, the camera of the G-buffer. Call at most once after each update; without it, or
    // if the graph's execution fails, the next update does again what the frame would have done.
    Result<gpu::ResourceId> add_passes(gpu::FrameGraph& graph, const scene::GpuScene& gpu_scene,
                                       const GBufferInput& g_buffer, const gpu::UploadSlice& camera,
                                       VkFormat output_format = VK_FORMAT_R16G16B16A16_SFLOAT);

    // The same into images of the caller's: four channels of float, storage write. `specular`: not valid where it is
    // not wanted; with it, every pixel is written, zero where nothing is glossy.
    Status add_passes(gpu::FrameGraph& graph, const scene::GpuScene& gpu_scene, const GBufferInput& g_buffer,
                      const gpu::UploadSlice& camera, gpu::ResourceId output, gpu::ResourceId specular = {});
    // Whether a technique owns specular light; after an update: and it is shown.
    bool lights_specular() const { return shown_.lights_any(~all_diffuse_cells()); }

    // Lights that another system has seen change (SampleSet::varying_lights): their next change is none to remember.
    void expect_varying(const std::set<ecs::Entity>& lights) { samples_.expect_varying(lights); }

    // The last update kept samples that no longer fit settings or scene (FrameInput::keep_samples).
    bool outdated() const { return samples_.outdated(); }

    // Where precomputed data is kept from run to run; empty (the default): it is computed in every run.
    void set_cache_folder(std::filesystem::path folder) { cache_folder_ = std::move(folder); }

    // What each technique's light gives a point of the scene, as it was at the last update; `rays` are those of that
    // update. In the space that is lit.
    std::vector<ExplainedLight> explain(const ReceiverPoint& point, const raytrace::RayScene& rays) const;
    // Draws one of all_overlays(), by name; nothing while its owner lights nothing. An error if there is none.
    Status draw_overlay(std::string_view name, OverlayLines& lines);
    // Fills one of all_listings(), by name, as things are after the last update. `place`, in the space that is lit: of
    // those that are of one; null: none is chosen. An error if there is no such listing.
    Result<ListingContent> fill_listing(std::string_view name, const ListedPlace* place);
    // One of the listing's actions, by its index, for a row of it: takes effect at the next update.
    Status act(std::string_view name, std::uint32_t action, std::uint32_t key, bool on);

    // Numbers of the last frame; all_counters() says which there are.
    const Report& counters() const { return report_; }
    // Of the last update and add_passes.
    const StageTimes& cpu_times() const { return cpu_times_; }

    const SampleSet& sample_set() const { return samples_; }
    std::span<const LightSample> samples() const { return samples_.samples(); }
    const ShadowService& shadows() const { return *shadows_; }
    // Empty unless a technique in use wants it.
    const VisibilityDatabase& visibility() const { return visibility_.database(); }
    const LightPlan& light_plan() const { return plan_; }
    // By its name in the list; null if there is none.
    Technique* technique(std::string_view name);

private:
    explicit System(gpu::Device& device) : max_buffer_bytes_(device.traits().max_storage_range), resources_(device) {}
    Services services();
    bool wants_visibility() const;
    CellSet cells_with_maps(const scene::GpuScene& gpu_scene) const;
    bool any_in_use(bool TechniqueEntry::*request) const;
    Status update_samples(const SceneView& scene);
    Status make_rows(const SceneView& scene, bool static_changed);
    Status update_visibility(const SceneView& scene, bool static_changed);
    Status update_techniques(const SceneView& scene);
    Status find_view();
    void make_report();

    std::uint64_t max_buffer_bytes_;
    gpu::FrameResources resources_;
    Settings settings_;
    LightPlan plan_;
    LightPlan shown_; // the same, or the part of the light that a view shows
    SampleSet samples_;
    std::unique_ptr<ShadowService> shadows_;
    SceneVisibility visibility_;
    std::unique_ptr<LightComposer> composer_;
    std::vector<std::unique_ptr<Technique>> techniques_; // as techniques() lists them
    FrameInput input_;
    const DebugView* view_ = nullptr;
    std::uint64_t settings_generation_ = 1;
    std::uint64_t geometry_generation_ = 0;
    bool recorded_ = true;               // the passes of the last update
    bool restart_ = false;               // the last frame never reached the GPU
    std::vector<std::uint8_t> restarts_; // by technique: it has not been told of such a frame yet
    std::filesystem::path cache_folder_;
    Report report_;
    StageTimes cpu_times_;
};

} // namespace sunfleck::gi

// sunfleck::gi::System: global illumination for one scene.
//
// Minimal loop of a host that uses the engine's frame graph:
//
//     auto system = gi::System::create({device, shaders}).value();
//     each frame:
//         changes = tracker.collect(registry, meshes)               // what moved; rays and GPU scene follow it
//         system->update(registry, changes, meshes, gpu_scene, rays, input) // CPU: samples, stale maps
//         graph.reset();  ... the host's geometry pass ...
//         irradiance = system->add_passes(graph, g_buffer, camera)  // declares the GPU work
//         graph.compile();  graph.execute(commands, resources, timers);
//
// The system never submits, waits, presents or owns a swapchain, and no frame waits for a read-back. It must be used
// from one thread at a time; update itself runs on all cores. The device, registry, meshes and GPU scene are the host's
// and must outlive it. Frames are told apart by serials that rise by one; resources of a frame are reused when
// `completed_serial` has reached it.
#pragma once

#include "engine/raytrace/ray_scene.h"
#include "gi_module/brute_force/brute_force.h"
#include "gi_module/light_sampling/blocked_paths.h"
#include "gi_module/light_sampling/dynamic_lights.h"
#include "gi_module/light_sampling/light_sampler.h"
#include "gi_module/many_light/many_light.h"
#include "gi_module/many_light/pass_grouping.h"
#include "gi_module/settings.h"
#include "gi_module/shadows/map_budget.h"
#include "gi_module/shadows/map_scheduler.h"
#include "gi_module/transfer/transfer_pass.h"
#include "gi_module/transport/g_buffer.h"
#include "gi_module/visibility/visibility_database.h"

#include <functional>
#include <map>
#include <memory>
#include <optional>

namespace sunfleck::gi {

// The module's embedded shaders, to be added to the host's ShaderLibrary before System::create.
std::span<const gpu::EmbeddedShader> shaders();

struct FrameInput {
    std::uint64_t serial = 1;
    std::uint64_t completed_serial = 0;
    // Shadow maps redrawn in this frame at most. Maps that wait stay as they were; Settings::map_priority says which
    // go first.
    std::uint32_t map_budget = 0xffffffffu;
    // What the GPU took for the passes called "shadow maps" and "shadow map copies" of an earlier frame, if the host
    // measures it; only for Settings::map_milliseconds.
    std::uint64_t measured_serial = 0;
    double measured_map_milliseconds = 0.0;
    // Reflected light is multiplied by this: 0 shows direct light alone, from the same samples.
    float indirect_scale = 1.0f;
    // False colours of the many-light system in place of the irradiance: shared::show_... (many_light_shared.h).
    std::uint32_t show = 0;
    // Called with the share that is done, 0 to 1, while an update takes long because everything is decided anew (the
    // first one of a level), from any thread but by one at a time. Returning false ends the update with an error; the
    // next one begins again.
    std::function<bool(float)> progress;
    // World to clip, of this frame's camera or the one before: which shadow maps matter most to the picture, and what
    // Settings::count_passes counts. Without it, maps are redrawn by flux, and no passes are counted.
    std::optional<mat4> view_projection;
};

// Of the last update and, for what the GPU counts, of the newest frame that is complete.
struct Counters {
    std::uint64_t light_samples = 0;
    std::uint64_t light_samples_direct = 0;
    std::uint64_t light_samples_dynamic = 0; // of emitters that move or vary
    std::uint64_t light_samples_moved = 0;   // in this frame
    std::uint64_t light_samples_blocked = 0; // whose light a door or the like keeps from them
    std::uint64_t shadow_map_updates = 0;
    std::uint64_t shadow_map_faces = 0;
    std::uint64_t shadow_map_vertices = 0;
    std::uint64_t shadow_maps_stale = 0; // after this frame
    std::uint64_t light_batches = 0;
    VisibilityCounters visibility; // of the many-light system, as the rest below
    std::uint64_t surface_patches = 0;
    std::uint64_t light_map_updates = 0;
    std::uint64_t light_map_texels = 0;
    std::uint64_t baked_light_updates = 0; // samples added or subtracted at a patch
    std::uint64_t baked_light_waiting = 0; // patches without baked light yet
    ManyLightCounters pixels;
    std::uint64_t render_passes = 0, render_passes_unoptimised = 0; // with Settings::count_passes
    std::uint64_t transfer_vertices = 0;                            // lit by precomputed transfer
    double pass_fill = 1.0;        // pairs of node and light in the passes, over those needed
    double clamped_flux = 0;       // W over the visible surface, luminance; needs settings.count_clamped
    double clamped_irradiance = 0; // W/m2, mean over pixels
};

class System {
public:
    static Result<std::unique_ptr<System>> create(gpu::Device& device, gpu::PipelineStore& pipelines);
    ~System();

    // Takes effect at the next update. Rejects values outside their described ranges.
    Status set_settings(const Settings& settings);
    const Settings& settings() const { return settings_; }

    // Follows the registry: light samples are made when settings, emitters or static geometry changed, and live on as
    // LightSample entities with a ShadowMap beside each; maps that a moved object may touch become stale. Ray scene and
    // GPU scene must have followed `changes`.
    Status update(ecs::Registry& registry, const scene::SceneChanges& changes, const scene::MeshStore& meshes,
                  const scene::GpuScene& gpu_scene, raytrace::RayScene& rays, const FrameInput& input);

    // Declares this frame's GPU work and returns the irradiance image, RGBA, W/m2 without albedo; alpha 0 where nothing
    // is. `camera` holds a CameraRow, the camera of the G-buffer. Call once after each update.
    Result<gpu::ResourceId> add_passes(gpu::FrameGraph& graph, const scene::GpuScene& gpu_scene,
                                       const GBufferInput& g_buffer, const gpu::UploadSlice& camera,
                                       VkFormat output_format = VK_FORMAT_R16G16B16A16_SFLOAT);

    // The same into an image of the caller's: four channels of float, storage write.
    Status add_passes(gpu::FrameGraph& graph, const scene::GpuScene& gpu_scene, const GBufferInput& g_buffer,
                      const gpu::UploadSlice& camera, gpu::ResourceId output);

    // Where precomputed transfer is kept from run to run; empty (the default): it is computed in every run.
    void set_cache_folder(std::filesystem::path folder) { cache_folder_ = std::move(folder); }

    const Counters& counters() const { return counters_; }
    // Milliseconds on the CPU of the last update, by stage.
    const std::map<std::string, double>& cpu_times() const { return cpu_times_; }
    const ShadowMaps& shadow_maps() const { return *shadow_maps_; }
    BruteForce& brute_force() { return *brute_force_; }
    const std::vector<LightSample>& samples() const { return samples_; }
    // Empty unless the technique is light_samples.
    const VisibilityDatabase& visibility() const { return database_; }
    const ManyLight& many_light() const { return *many_light_; }
    const CurvedCharts& curved_charts() const { return curved_charts_; }
    const MapScheduler& map_scheduler() const { return scheduler_; }
    // The bound of the geometry term in use, 1/m2 (see transport/clamping.h); single samples may have lower ones.
    float geometry_bound() const { return bound_; }
    // What shaders see of the samples, in their order.
    std::span<const shared::LightRow> light_rows() const { return rows_; }

private:
    System(gpu::Device& device) : device_(device), resources_(device) {}
    bool uses_many_light() const;
    void find_emitters(ecs::Registry& registry, const scene::SceneChanges& changes, const scene::MeshStore& meshes,
                       const Bounds& bounds);
    bool find_varying(ecs::Registry& registry);
    bool needs_new_samples(const raytrace::RayScene& rays);
    void follow_dynamic_lights(ecs::Registry& registry, const raytrace::RayScene& rays);
    void make_samples(ecs::Registry& registry, const raytrace::RayScene& rays);
    void mirror_samples(ecs::Registry& registry);
    Status configure_maps();
    void update_rows(const Bounds& bounds, const raytrace::RayScene& rays);
    Status update_visibility(ecs::Registry& registry, const scene::SceneChanges& changes,
                             const scene::MeshStore& meshes, const scene::GpuScene& gpu_scene, bool static_changed);
    void update_movers(const scene::SceneChanges& changes, const scene::MeshStore& meshes,
                       const scene::GpuScene& gpu_scene, bool all);
    Status update_transfer(const ecs::Registry& registry, const scene::MeshStore& meshes,
                           const scene::GpuScene& gpu_scene, const raytrace::RayScene& rays);
    void count_passes();
    std::vector<float> contributions_of_stale_maps(const scene::GpuScene& gpu_scene, std::uint32_t budget) const;
    void mark_by_visibility(const scene::GpuScene& gpu_scene);
    void mark_by_bounds(const scene::GpuScene& gpu_scene);
    Result<std::vector<LightBatch>> make_batches(std::uint32_t first, std::uint32_t count);
    std::vector<ShadowRequest> make_requests(std::span<const std::uint32_t> samples) const;
    Status add_brute_force(gpu::FrameGraph& graph, const scene::GpuScene& gpu_scene, const GBufferInput& g_buffer,
                           const gpu::UploadSlice& camera, gpu::ResourceId output);
    Status add_many_light(gpu::FrameGraph& graph, const scene::GpuScene& gpu_scene, const GBufferInput& g_buffer,
                          const gpu::UploadSlice& camera, gpu::ResourceId output);

    gpu::Device& device_;
    gpu::FrameResources resources_;
    std::unique_ptr<ShadowMaps> shadow_maps_;
    std::unique_ptr<BruteForce> brute_force_;
    std::unique_ptr<ManyLight> many_light_;
    std::uint64_t curved_generation_ = 0; // of the database that they were found for
    CurvedCharts curved_charts_;          // of the database's static geometry, while light is baked
    std::unique_ptr<TransferPass> transfer_pass_;
    TransferLighting transfer_;
    std::filesystem::path cache_folder_;
    Settings settings_, sampled_settings_;
    std::vector<Emitter> emitters_;         // whose samples stay
    std::vector<Emitter> dynamic_emitters_; // that move or vary
    std::set<ecs::Entity> varying_;         // do not move, but have changed their strength
    std::map<ecs::Entity, vec3> last_flux_; // of those that do not move
    DynamicLights dynamic_lights_;
    BlockedPaths blocked_paths_;
    std::vector<std::uint32_t> dynamic_samples_; // where each of theirs is among all
    std::vector<std::uint32_t> changed_samples_; // in this frame
    std::vector<LightSample> samples_;           // grouped by class, direct before indirect
    std::vector<shared::LightRow> rows_;         // of the samples
    float lag_limit_ = 0.0f; // m, of MapScheduler::lag: a mover that is farther from where it was does not touch itself
    std::vector<ecs::Entity> entities_; // of the samples
    MapScheduler scheduler_;
    MapBudget map_budget_;
    std::vector<std::uint32_t> to_draw_;
    VisibilityDatabase database_;
    VisibilityOptions database_options_;
    scene::ChangeCursor emitter_cursor_, mover_cursor_; // of emitters_, and of the movers in database_
    Bounds emitter_bounds_;                             // that emitters_ were found in
    MoverHandling emitter_movers_ = MoverHandling::as_static, database_movers_ = MoverHandling::as_static;
    std::unique_ptr<PassGrouping> passes_; // if they are counted
    std::uint64_t passes_generation_ = 0;  // of the database
    std::uint32_t passes_lights_ = 0;
    bool passes_extras_ = false;
    std::map<std::uint32_t, PassLights> seen_nodes_;
    std::uint64_t database_samples_ = 0; // the set of samples that the database knows
    std::uint64_t database_geometry_ = 0;
    bool samples_valid_ = false;
    std::uint64_t sample_generation_ = 0;
    std::uint64_t geometry_generation_ = 0;
    std::uint64_t emitter_hash_ = 0;
    Bounds scene_bounds_;
    float bound_ = 0.0f;
    FrameInput input_;
    Counters counters_;
    std::map<std::string, double> cpu_times_;
};

} // namespace sunfleck::gi

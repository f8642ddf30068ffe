// What a technique is: a folder that gives gi::System a described settings struct and four functions (creation, update,
// add_passes, report), announced by one TechniqueEntry. techniques() is the only list of them; neither System nor any
// host, tool or document names one.
//
// To add one: a folder with a `technique.cmake`, its name in the list of gi_module/CMakeLists.txt. Or, from outside of
// the module, add_technique().
#pragma once

#include "engine/core/stage_times.h"
#include "engine/gpu/frame_graph.h"
#include "engine/gpu/shader_library.h"
#include "gi_module/inspection/light_shares.h"
#include "gi_module/inspection/overlays.h"
#include "gi_module/light_sum/light_sum.h"
#include "gi_module/low_resolution/low_resolution.h"
#include "gi_module/settings.h"
#include "gi_module/shadows/shadow_service.h"
#include "gi_module/transport/g_buffer.h"
#include "gi_module/transport/light_plan.h"
#include "gi_module/transport/listing.h"
#include "gi_module/transport/report.h"

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>

namespace sunfleck::gi {

// Of one frame, from the host.
struct FrameInput {
    std::uint64_t serial = 1;
    std::uint64_t completed_serial = 0;
    // The frame that was recorded last never reached the GPU (its command buffer was not submitted): what it would have
    // drawn or copied is done again.
    bool previous_frame_lost = false;
    // Shadow maps redrawn in this frame at most. Maps that wait stay as they were; ShadowSettings::map_priority says
    // which go first. With a budget, light is baked, and light maps are summed, in short portions, too.
    std::uint32_t map_budget = 0xffffffffu;
    // Samples whose strength changes in this frame at most while they stay where they are (a lamp that is switched,
    // light that a door lets in, `indirect_scale`): the others follow in later frames, those near the camera of
    // `view_projection` first. It bounds what such a change costs a frame, by a count, so that the same frames give the
    // same pictures.
    std::uint32_t strength_budget = 0xffffffffu;
    // Thousands of light samples times texels that are evaluated in this frame at most to refine the light of what
    // stands still (`baked_samples`): 4,000 take 15 to 30 ms of two cores. By a count, too.
    std::uint32_t refinement_budget = 0xffffffffu;
    // Where settings, static geometry or static emitters have changed, or a lamp its strength for the first time,
    // samples, visibility and static shadows stay as they are, and System::outdated() is true: for hosts that prepare
    // new ones beside their frames (with a second system). Without it, the update makes them, which may take seconds.
    bool keep_samples = false;
    // The host's time, ms, real or simulated. With it, no shadow map that shows is out of date for longer than 100 ms
    // or two frames, whichever is longer, whatever ShadowSettings::map_budget says.
    std::optional<double> milliseconds;
    // What the GPU took for the passes called "shadow maps" and "shadow map copies" of an earlier frame, if the host
    // measures it; only for ShadowSettings::map_milliseconds.
    std::uint64_t measured_serial = 0;
    double measured_map_milliseconds = 0.0;
    // Reflected light is multiplied by this: 0 shows direct light alone, from the same samples.
    float indirect_scale = 1.0f;
    // False: the picture of this frame is not used. Shadow maps, light maps and baked light are brought up to date, and
    // no pixel is lit by the techniques that do so one by one: for hosts that prepare lighting beside their frames.
    bool light_pixels = true;
    // Pixels are lit by the kernels for shadow maps that are out of date, even where none is. For preparations: some
    // drivers compile a kernel only when it first runs, and the first mover that moves would wait for that.
    bool as_if_stale = false;
    // Name of a debug view (debug_views()) in place of the irradiance; empty: none.
    std::string_view view{};
    // Called with the share that is done, 0 to 1, while an update takes long because everything has to be computed (the
    // first one of a level), from any thread, never concurrently. Returning false ends the update with an error; the
    // next one begins again.
    std::function<bool(float)> progress;
    // World to clip, of this frame's camera or the one before: which shadow maps matter most to the picture, and what
    // passes are counted for. Without it, maps are redrawn by flux, and no passes are counted.
    std::optional<mat4> view_projection;
};

// What all techniques share in a frame. Valid during the call that it is handed to.
struct Services {
    const Settings& settings;
    const FrameInput& input;
    const SampleSet& samples;
    ShadowService& shadows;
    // Null unless a technique in use wants it (TechniqueEntry::wants_visibility).
    VisibilityDatabase* visibility;
    gpu::FrameResources& resources;
    // What was handed to the GPU since the last frame that reached it is lost: upload and sum everything again.
    bool restart = false;
    // Where precomputed data is kept from run to run; empty: nowhere.
    const std::filesystem::path& cache_folder;
    StageTimes& cpu_times;

    // Shadows are looked up by the kernels for maps that show movers where they were.
    bool maps_are_stale() const;
};

// Where light goes: W/m2 without albedo; alpha 1 where there is a surface, else 0.
struct LightTarget {
    const scene::GpuScene& gpu_scene;
    const GBufferInput& g_buffer;
    const gpu::UploadSlice& camera; // a CameraRow, the camera of the G-buffer
    // The technique writes every pixel of `area` (at first the whole picture, which it may make smaller where it has
    // light in a part only), with the light that it owns.
    gpu::ResourceId irradiance;
    PixelArea area{};
    // Of a technique that lights pixels: its memory for a group of them (LowResolutionFrame).
    std::uint64_t bytes_per_group = 4;
    // False colours instead, if they are one of the technique's views; else null.
    const DebugView* view = nullptr;
    // TechniqueEntry::adds_in_place: the image holds light, to which the technique adds its own.
    bool holds_light = false;
    // Of a technique with TechniqueEntry::lights_specular, which writes this one's glossy pixels and reads
    // `irradiance`, which holds all diffuse light. See transport/g_buffer.h.
    gpu::ResourceId specular{};
};

// The place that a listing is asked about.
struct ListedPlace {
    ecs::Entity entity; // whose surface it is
    ReceiverPoint point;
};

class Technique {
public:
    virtual ~Technique() = default;
    // Follows the scene on the CPU. `cells`: the light that is the technique's in this frame; at least one.
    virtual Status update(const SceneView& scene, Services& services, CellSet cells) = 0;
    // Declares the frame's GPU work. Once after each update. A technique that lights pixels does here what comes before
    // that, and leaves the target alone.
    virtual Status add_passes(gpu::FrameGraph& graph, Services& services, LightTarget& target) = 0;
    // TechniqueEntry::lights_pixels: adds its light to the sums of a stage's pixels; for each stage, after add_passes.
    virtual Status light_pixels(const PixelStage& stage, Services& services);
    // Counters and memory of the last frame; for what the GPU counts, of the newest one that is complete.
    virtual void report(Report& report) const = 0;
    // Which light gives how much of the irradiance that the technique gives a point, for tools. None: it cannot say.
    virtual std::optional<std::vector<LightShare>> explain(const PointQuestion& question) const;
    // Draws one of the technique's overlays, as things are after the last update.
    virtual void draw_overlay(const Overlay& overlay, const Services& services, OverlayLines& lines) const;
    // Fills one of the technique's tables, as things are after the last update. `place`: of those that are of one.
    virtual ListingContent fill_listing(const Listing& listing, const Services& services,
                                        const ListedPlace* place) const;
    // One of the listing's actions, by its index, for a row of it.
    virtual void act(const Listing& listing, std::uint32_t action, std::uint32_t key, bool on);
};

struct TechniqueEntry {
    std::string_view name; // --direct NAME, --indirect NAME, --movers NAME
    std::string_view tooltip;
    CellSet can_light;
    // Null: it lights every receiver of those cells. Else it lights only movers for which this holds; the others are
    // lit by whoever would light them without it.
    bool (*supports)(const scene::DrawItem& mover, const ecs::Registry& registry,
                     const scene::MeshStore& meshes) = nullptr;
    // Cells that it takes from their owners by a setting of its own (TermOwners::taken); null: none.
    CellSet (*takes)(const Settings& settings) = nullptr;
    bool wants_visibility = false;
    // Its shadow test does not allow for movers that maps show simplified: while it is in use, none are
    // (ShadowSettings::map_detail).
    bool needs_full_maps = false;
    // It reads the shadow maps of its light samples (ShadowService). Maps that nobody reads are not drawn.
    bool reads_maps = true;
    // It evaluates light pixel by pixel, at low resolution (low_resolution/): light_pixels is called.
    bool lights_pixels = false;
    // It lights specular cells, after all others: add_passes is called where the host wants specular light.
    bool lights_specular = false;
    // It can add its light to a picture that holds other light, which saves a layer and a pass.
    bool adds_in_place = false;
    TechniqueSettings settings;
    std::span<const Counter> counters{};
    std::span<const DebugView> views{};
    std::span<const Overlay> overlays{};
    std::span<const Listing> listings{};
    std::span<const gpu::EmbeddedShader> (*shaders)() = nullptr;
    Result<std::unique_ptr<Technique>> (*create)(gpu::Device& device, gpu::PipelineStore& pipelines) = nullptr;
};

// All techniques, in the order in which they are offered and add their light; the first that can light a term is its
// default.
std::span<const TechniqueEntry> techniques();
// Adds one from outside of the module, at the end. Call before anything else of the module is used; from one thread.
void add_technique(const TechniqueEntry& entry);

// Everything that is declared: of the rooms that techniques share, and of all techniques.
std::vector<const Counter*> all_counters();
std::vector<const DebugView*> debug_views();
std::vector<const Overlay*> all_overlays();
std::vector<const Listing*> all_listings();

} // namespace sunfleck::gi

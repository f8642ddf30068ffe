// Shadow maps for all techniques: one store, one scheduler, one budget. A technique that owns light needs maps; which
// of them are redrawn in a frame is decided here.
//
// A frame: begin_frame -> configure -> follow -> schedule (CPU, in System::update), add_passes (GPU work). Maps count
// as drawn from then on, unless the next begin_frame says that this work never reached the GPU.
#pragma once

#include "gi_module/light_sampling/sample_set.h"
#include "gi_module/shadows/map_budget.h"
#include "gi_module/shadows/map_scheduler.h"
#include "gi_module/shadows/shadow_maps.h"
#include "gi_module/shadows/shadow_settings.h"
#include "gi_module/transport/light_plan.h"
#include "gi_module/transport/listing.h"
#include "gi_module/visibility/visibility_database.h"

namespace sunfleck::gi {

// How maps are maintained. `database`: the visibility database follows the scene, so it is known which maps a mover
// affects and which occluders are hidden; maps are then kept for all samples and redrawn within a budget, and movers
// are drawn over the static part. Without it (the baseline, unless ShadowSettings::kept_maps), every map that a mover
// may affect is redrawn completely.
struct MapPolicy {
    bool database = true;
    bool full_detail = false; // whoever reads the maps needs movers as they are, whatever the settings
};

struct ScheduleInput {
    const scene::GpuScene& gpu_scene;
    const VisibilityDatabase* database = nullptr; // null: MapPolicy::database is off
    std::uint64_t serial = 0;
    std::uint32_t host_budget = 0xffffffffu; // maps; also limits the budget of the settings
    std::optional<mat4> view_projection;
    CellSet read = CellSet().set();       // light whose maps somebody reads
    std::optional<double> milliseconds{}; // FrameInput::milliseconds
};

// State of one sample's map, for inspection.
struct MapState {
    std::uint32_t slot = 0;
    std::uint32_t resolution = 0;         // texels along a side
    std::uint32_t frames_out_of_date = 0; // 0: up to date
    bool static_part_valid = false;       // false: nothing in the map can be relied on
};

class ShadowService {
public:
    static Result<std::unique_ptr<ShadowService>> create(gpu::Device& device, gpu::PipelineStore& pipelines);

    // `previous_lost`: the passes added since the last call never reached the GPU; maps are as stale as before them.
    void begin_frame(bool previous_lost);
    // Allocates the maps of `count` samples. Call before SampleSet::update_rows, which needs slots().
    Status configure(const ShadowSettings& settings, MapPolicy policy, std::uint32_t count,
                     gpu::FrameResources& resources);
    // Marks the maps whose static part is stale because their samples changed. `static_changed`: all maps.
    void follow(const SampleSet& samples, bool static_changed);
    // Marks the maps that movers affect, and chooses those to redraw.
    void schedule(const SampleSet& samples, const ScheduleInput& input);
    // GPU time of an earlier frame's maps, ms; only used for ShadowSettings::map_milliseconds.
    void measured(std::uint64_t serial, double milliseconds) { budget_.add_time(serial, milliseconds); }

    // Adds the passes that redraw the chosen maps. `read`: also that no other map lights anything if it has not been
    // drawn yet; else these hold anything, until a frame reads them.
    Status add_passes(gpu::FrameGraph& graph, const scene::GpuScene& gpu_scene, const SampleSet& samples, bool read,
                      gpu::FrameResources& resources);
    // For more samples than slots, which then share them in turn: adds the passes that draw the maps of samples
    // [first, first + count) over those that used the slots before.
    Status add_map_range(gpu::FrameGraph& graph, const scene::GpuScene& gpu_scene, const SampleSet& samples,
                         std::uint32_t first, std::uint32_t count, gpu::FrameResources& resources);

    const ShadowMaps& maps() const { return *maps_; }
    const ShadowSettings& settings() const { return settings_; }
    std::uint32_t slots() const { return std::max(maps_->slots(), 1u); }
    bool slots_are_shared(std::uint32_t samples) const { return settings_.shadows && samples > slots(); }
    // Samples whose maps this frame redraws, in ascending order.
    std::span<const std::uint32_t> to_draw() const { return to_draw_; }
    // After add_passes, the maps in to_draw count as up to date.
    std::uint32_t frames_out_of_date(std::uint32_t sample) const { return scheduler_.frames_out_of_date(sample); }
    std::span<const std::uint32_t> ages() const { return scheduler_.ages(); }
    bool is_static_stale(std::uint32_t sample) const { return scheduler_.is_static_stale(sample); }
    std::size_t stale() const { return scheduler_.stale(); }
    // Upper bound of how far movers are from where the sample's map shows them, m; limited to what can matter.
    float lag(std::uint32_t sample) const { return std::min(scheduler_.lag(sample), lag_limit_); }
    // Whether movers are simplified in the maps.
    bool simplifies_movers() const { return policy_.database && !policy_.full_detail && settings_.map_detail; }
    MapState state(const SampleSet& samples, std::uint32_t sample) const;

    // For tools: the maps as a table, as they are after the last update, and what is asked of one of them (`action`: of
    // its listing), for the next one.
    static std::span<const Listing> listings();
    ListingContent list_maps(const SampleSet& samples) const;
    void act(std::uint32_t action, std::uint32_t sample, bool on);

    static std::span<const Counter> counters();
    void report(Report& report) const;

private:
    void set_unread_aside(const SampleSet& samples, CellSet read);
    void mark_by_visibility(const SampleSet& samples, const ScheduleInput& input);
    void mark_by_bounds(const SampleSet& samples, const scene::GpuScene& gpu_scene);
    std::vector<float> priorities(const SampleSet& samples) const;
    std::uint32_t budget_of(const ScheduleInput& input) const;
    std::vector<float> contributions(const SampleSet& samples, const ScheduleInput& input, std::uint32_t budget) const;
    std::vector<ShadowRequest> requests(const SampleSet& samples, std::span<const std::uint32_t> drawn) const;
    void clear_undefined(gpu::FrameGraph& graph, const SampleSet& samples);
    Status draw(gpu::FrameGraph& graph, const scene::GpuScene& gpu_scene, const SampleSet& samples,
                std::span<const std::uint32_t> drawn, gpu::FrameResources& resources);

    std::unique_ptr<ShadowMaps> maps_;
    MapScheduler scheduler_;
    MapBudget budget_;
    ShadowSettings settings_;
    MapPolicy policy_;
    // Of this frame.
    const VisibilityDatabase* database_ = nullptr;
    const scene::GpuScene* gpu_scene_ = nullptr;
    std::optional<mat4> view_projection_;
    std::vector<std::uint32_t> to_draw_;
    std::vector<std::uint8_t> unread_; // by sample: 1 if nobody reads its map
    std::uint64_t sample_generation_ = 0;
    bool cleared_ = false;    // all maps lost their content in configure
    bool simplified_ = false; // movers, in the maps of the last frame
    bool redetailed_ = false; // that changed in this frame
    float lag_limit_ = 0.0f;  // m: a mover that has moved farther does not overlap its old position
    ShadowCounters drawn_;    // in this frame
};

} // namespace sunfleck::gi

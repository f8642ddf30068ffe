// Light maps: for each flat patch, the unshadowed irradiance of all samples that reach it ("none" and "partial"), as a
// grid of texels. Thesis sec. 4.3.2 and 4.5.2.
//
// Sums are kept in fixed point, so that adding and subtracting single samples in any order gives the same bits as
// summing from the start. A texel's first and last columns and rows lie on the patch's border: where neighbouring
// patches have the same samples, they have the same values there, and no seam shows.
//
// Which samples they hold: held_by_light_maps (light_map_jobs.h).
#pragma once

#include "engine/gpu/frame_graph.h"
#include "gi_module/many_light/light_map_jobs.h"
#include "gi_module/many_light/surface_tables.h"
#include "gi_module/visibility/visibility_database.h"

namespace sunfleck::gi {

// The side of a texel, m, where samples' geometry terms are bounded by `bound`, 1/m2 (0: by nothing).
float light_map_texel(float bound);

struct LightMapCounters {
    std::uint64_t updates = 0; // single contributions added, replaced or subtracted in the last update
    std::uint64_t texels = 0;
    std::uint64_t waiting = 0; // jobs that later frames do
};

class LightMaps {
public:
    static Result<std::unique_ptr<LightMaps>> create(gpu::Device& device, gpu::PipelineStore& pipelines);

    // Follows the database's changes; `rows` are the samples' rows by index. Everything is summed again when the
    // database's generation, the samples or their bound changed; of samples that only changed their strength (doors do
    // that), the old light is subtracted and the new one added. `in_portions`: the first sums of a database are
    // divided among frames, until something in them changes; meanwhile, no map is complete().
    Status update(const VisibilityDatabase& database, std::span<const LightSample> samples,
                  std::span<const shared::LightRow> rows, bool in_portions, gpu::FrameResources& resources);
    // All is summed again by the next update.
    void restart();
    // Adds the passes that bring the maps up to date; nothing if they are.
    Status add_passes(gpu::FrameGraph& graph, gpu::FrameResources& resources);

    // After this frame's passes, all maps hold what they should; else, nobody may read them.
    bool complete() const { return counters_.waiting == 0; }
    // By node of the database.
    const std::vector<shared::NodeRow>& node_rows() const { return node_rows_; }
    const gpu::Buffer& texels() const { return texels_; }
    // Steps a W/m2.
    float fixed_point() const { return fixed_point_; }
    const LightMapCounters& counters() const { return counters_; }

private:
    explicit LightMaps(gpu::Device& device) : device_(device) {}
    std::uint64_t place_maps(const VisibilityDatabase& database, float texel_side);
    Status lay_out(const VisibilityDatabase& database, float texel_side, gpu::FrameResources& resources);
    void sum_all(const VisibilityDatabase& database, std::span<const LightSample> samples);
    void take_portion(bool only_one);
    void follow_changes(const VisibilityDatabase& database, std::span<const LightSample> samples,
                        std::span<const std::uint32_t> changed);

    gpu::Device& device_;
    std::vector<shared::NodeRow> node_rows_;
    gpu::Buffer texels_;
    float fixed_point_ = 1.0f;
    bool steps_are_coarse_ = false; // then no patch has a map
    std::uint64_t generation_ = 0;
    std::vector<shared::LightRow> summed_rows_; // what the maps were made with
    std::vector<shared::LightRow> job_rows_;    // those, then add_replacements of samples whose strength changed
    LightMapJobs sums_;                         // of all, from the start
    std::size_t portion_ = 0, next_ = 0;        // of sums_: this frame's begin and end
    LightMapJobs changes_;                      // after those
    const gpu::Pipeline* kernel_ = nullptr;
    LightMapCounters counters_;
};

} // namespace sunfleck::gi

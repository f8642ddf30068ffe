// Baked light: what light maps hold, with the shadows of static geometry, summed in the same texels while the program
// runs. This goes beyond the thesis, whose light maps are unshadowed (sec. 4.3.2), so that it tests every partly
// occluded sample again at every pixel and frame, though static geometry's answer never changes.
//
// Between texels, light is interpolated only where it is smooth: a cell of four texels is rough if second differences
// about its corners exceed a share of the light. Pixels of smooth cells take their light from here, and the only
// samples evaluated there are those that meet a mover (VisibilityDatabase::meets_mover): what the mover takes away is
// the difference of the sample's visibility in the static and in the current shadow map. Pixels of rough cells are lit
// as if nothing was baked. Curved surfaces have texels of their own (curved_charts.h), after those of the light maps.
//
// Baking is work of many frames, so much a frame; a patch or chart that waits is rough. A sample that changed its
// strength is replaced, to the last bit, as in light maps, and rough cells are marked again once no more samples wait;
// patches for which that is too much for a frame wait, and the others stay as they are.
#pragma once

#include "engine/gpu/frame_graph.h"
#include "gi_module/charts/curved_charts.h"
#include "gi_module/many_light/light_map_jobs.h"
#include "gi_module/many_light/light_maps.h"
#include "gi_module/many_light/many_light_scene.h"
#include "gi_module/many_light/surface_tables.h"
#include "gi_module/shadows/shadow_maps.h"
#include "gi_module/visibility/visibility_database.h"

namespace sunfleck::gi {

struct BakedLightCounters {
    std::uint64_t updates = 0; // samples added, replaced or subtracted at a patch in the last update
    std::uint64_t waiting = 0; // patches and charts
};

class BakedLight {
public:
    static Result<std::unique_ptr<BakedLight>> create(gpu::Device& device, gpu::PipelineStore& pipelines);

    // Follows the light maps, whose update comes first. Not in use afterwards if the device's texel buffers are too
    // small for them. `curved` are charts of the database's generation. `static_maps_changed`: a static shadow map of a
    // held sample is redrawn in this frame, and everything is baked again. `in_portions`: not most of it at once, as in
    // the first frame of a database, which is long anyway.
    Status update(const ManyLightScene& scene, const LightMaps& light_maps, bool static_maps_changed, bool in_portions,
                  gpu::FrameResources& resources);
    // Nothing is baked, nor used until the next update: shadow maps do not hold what is needed.
    void forget();
    bool in_use() const { return in_use_; }

    // Whether cells are rough is judged by the light that is shown: if `refined`, that of `texels`
    // (RefinedLight::texels). Where this changes, cells are marked again, from the next update on.
    void judge_by(const gpu::Buffer& texels, bool refined);
    bool marks_again() const { return next_marked_ < pieces_.size(); }

    // Adds the passes that do the frame's share. After those that draw shadow maps.
    Status add_passes(gpu::FrameGraph& graph, const ShadowMaps& maps, bool filter, gpu::FrameResources& resources);

    // By texel of the light maps: irradiance, W/m2, of 16-bit floats; alpha 0 if the cell up to the next column and row
    // is smooth. Then those of the curved charts' points: alpha is the mean height of the cell, or
    // shared::curved_rough.
    const gpu::Buffer& texels() const { return texels_; }
    // The same before it is rounded: ivec4, in light maps' fixed point.
    const gpu::Buffer& sums() const { return sums_; }
    // shared::CurvedChartRows, as texels of four floats.
    const gpu::Buffer& curved_rows() const { return curved_rows_.buffer(); }
    std::uint64_t memory_bytes() const {
        return sums_.size() + texels_.size() + points_.buffer().size() + curved_rows_.buffer().size();
    }
    const BakedLightCounters& counters() const { return counters_; }

    // A patch, or a chart of a curved surface.
    struct Piece {
        shared::LightMapJob job;          // but for its changes
        std::vector<std::uint32_t> nodes; // of the database, that it lies on

        std::uint64_t texels() const { return std::uint64_t(job.columns) * job.rows; }
    };
    // The changes of the last job of `jobs`, that of the piece: all samples whose light reaches it, as it is baked. The
    // row of the first sample is `first_row`.
    static void add_samples(LightMapJobs& jobs, const VisibilityDatabase& database,
                            std::span<const LightSample> samples, const Piece& piece, std::uint32_t first_row);
    const std::vector<Piece>& pieces() const { return pieces_; }
    std::uint64_t pieces_generation() const { return generation_; } // of the database
    std::uint64_t texel_count() const { return texel_count_; }      // of all pieces
    const gpu::Buffer& points() const { return points_.buffer(); }  // CurvedPoints
    float fixed_point() const { return fixed_point_; }

private:
    BakedLight(gpu::Device& device, gpu::PipelineStore& pipelines) : device_(device), pipelines_(pipelines) {}
    void find_pieces(const VisibilityDatabase& database, const LightMaps& light_maps, const CurvedCharts& curved);
    Status start_anew(const VisibilityDatabase& database, const LightMaps& light_maps, const CurvedCharts& curved,
                      std::span<const shared::LightRow> rows, gpu::FrameResources& resources);
    Status upload_charts(std::uint64_t first_texel, const CurvedCharts& curved, gpu::FrameResources& resources);
    void follow_strengths(const VisibilityDatabase& database, std::span<const shared::LightRow> rows,
                          std::span<const std::uint32_t> changed, bool more_follow);
    void bake_later(std::uint32_t piece);
    void mark_again(std::uint64_t most_texels);
    void add_wipe(gpu::FrameGraph& graph);
    Status upload_jobs(gpu::FrameGraph& graph, gpu::FrameResources& resources);
    std::uint32_t take_waiting(const VisibilityDatabase& database, std::span<const LightSample> samples,
                               std::uint64_t most);
    void bake_waiting(const VisibilityDatabase& database, std::span<const LightSample> samples, std::uint64_t most);

    gpu::Device& device_;
    gpu::PipelineStore& pipelines_;
    gpu::Buffer sums_;   // fixed point, as in light maps
    gpu::Buffer texels_; // what is shown
    gpu::UploadedBuffer points_, curved_rows_;
    gpu::UploadedBuffer job_texels_, finish_texels_, row_texels_; // of the frame
    std::vector<Piece> pieces_;
    bool in_use_ = false;
    bool wipe_ = false;                // all texels become rough in this frame
    std::vector<std::uint32_t> wiped_; // or those of these pieces
    std::vector<std::uint8_t>
        roughness_waits_;                // by piece: its light has changed, its rough cells are to be marked again
    std::uint32_t roughness_waited_ = 0; // frames
    std::uint64_t generation_ = 0, texel_count_ = 0;
    float fixed_point_ = 0.0f;
    std::vector<shared::LightRow> baked_rows_; // what was baked with, or will be
    std::vector<shared::LightRow> job_rows_;   // those, then add_replacements of samples whose strength changed
    std::vector<std::uint32_t> waiting_;       // pieces, the next one last
    std::uint64_t evaluations_ = 0;            // samples times texels, of this frame
    LightMapJobs jobs_, finish_;               // sums; then cells
    const gpu::Buffer* refined_texels_ = nullptr;
    bool refined_ = false;
    std::size_t next_marked_ = 0; // piece whose cells are to be marked again, and all after it
    BakedLightCounters counters_;
};

} // namespace sunfleck::gi

// Refined light: how much brighter or darker each texel of baked light would be if its light came from many times as
// many samples (VPLs) as there are in a frame. The samples of a frame are few because movers, doors and strengths are
// followed by each; what stands still is lit by all of it, and few samples show there: as stains, as steps between
// broad shadows, and as corners that are too dark, since nearby samples are bounded (transport/clamping.h).
//
// A second set, of the same emitters and surfaces (SampleSet::refining_samples), is large. Its shadow maps, of static
// geometry alone, live for as long as a group of samples is summed, so memory does not grow with their number. The
// light of the frame's own samples is summed as it is baked, but as if no door were shut; the ratio of both is all that
// is kept. It scales what the frame's samples give: a door that shuts, a lamp that is switched off or a mover in the
// way take away their share of the refined light, too, and where all of theirs is gone, none is left.
//
// It depends on the samples of the frame, and on nothing that happens later. A few milliseconds of each frame go into
// it until it is there.
#pragma once

#include "gi_module/many_light/baked_light.h"
#include "gi_module/many_light/nearby_light.h"

#include "gi_module/light_sampling/sample_set.h"
#include "gi_module/transport/light_plan.h"

namespace sunfleck::gi {

// What light is refined of.
struct RefinedLightScene {
    const VisibilityDatabase& database;
    const SampleSet& samples; // of the frame
    const CurvedCharts& curved;
    CellSet cells; // whose light is baked
    const raytrace::RayScene& rays;
    const LightSettings& light_settings;
    Bounds bounds;
};

class RefinedLight {
public:
    static Result<std::unique_ptr<RefinedLight>> create(gpu::Device& device, gpu::PipelineStore& pipelines);

    // Follows baked light, whose update comes first. `budget`: FrameInput::refinement_budget.
    Status update(const RefinedLightScene& scene, const BakedLight& baked, std::uint32_t budget,
                  gpu::FrameResources& resources);
    // It starts from the beginning at the next update.
    void forget();
    // The same if the last update had any work, which did not reach the GPU, or is not known to have.
    void restart();
    // Adds the passes that do the frame's share. `maps` and `filter`: as for BakedLight::add_passes.
    Status add_passes(gpu::FrameGraph& graph, const scene::GpuScene& gpu_scene, const BakedLight& baked,
                      const ShadowMaps& maps, bool filter, gpu::FrameResources& resources);

    // How far light is refined in this frame: 0 not at all, 1 in full. It grows from frame to frame once all is known.
    float share() const { return share_; }
    // By texel of baked light: see refined_texel.glsl.
    const gpu::Buffer& texels() const { return refined_texels_; }
    // Samples whose light is still to be summed, and one until it is shown in full.
    std::uint64_t waiting() const { return unsummed() + (!rows_.empty() && share_ < 1.0f ? 1 : 0); }
    std::uint64_t memory_bytes() const;

private:
    RefinedLight(gpu::Device& device, gpu::PipelineStore& pipelines) : device_(device), pipelines_(pipelines) {}
    // What the ratios depend on: where any of it changes, they are computed from scratch.
    struct Cause {
        std::uint64_t samples = 0, pieces = 0; // generations
        CellSet cells;
        float clamp_scale = 0.0f, fixed_point = 0.0f;
        bool operator==(const Cause&) const = default;
    };
    std::uint64_t unsummed() const { return rows_.size() - group_begin_; }
    Status begin(const RefinedLightScene& scene, const BakedLight& baked, std::uint32_t group,
                 gpu::FrameResources& resources);
    float make_rows(const RefinedLightScene& scene);
    void begin_nearby(const RefinedLightScene& scene, const BakedLight& baked, float bound);
    NearbyLightScene nearby_scene(const RefinedLightScene& scene, const BakedLight& baked) const;
    void begin_group(std::uint32_t begin);
    void take_portion(const RefinedLightScene& scene, const BakedLight& baked, std::uint64_t most);
    void add_job(LightMapJobs& jobs, const shared::LightMapJob& piece) const;
    void add_own_job(LightMapJobs& jobs, const RefinedLightScene& scene, const BakedLight::Piece& piece) const;
    Status add_maps(gpu::FrameGraph& graph, const scene::GpuScene& gpu_scene, gpu::FrameResources& resources);
    Status add_sums(gpu::FrameGraph& graph, const BakedLight& baked, const ShadowMaps& maps, bool filter,
                    gpu::FrameResources& resources);
    Status add_ratios(gpu::FrameGraph& graph);

    gpu::Device& device_;
    gpu::PipelineStore& pipelines_;
    std::unique_ptr<ShadowMaps> maps_;    // of a group's samples
    gpu::Buffer own_sums_, refined_sums_; // fixed point, as in baked light
    gpu::Buffer refined_texels_;          // ratios and sources, see refined_texel.glsl
    gpu::UploadedBuffer job_texels_, row_texels_;
    Cause cause_;
    std::vector<shared::LightRow> own_rows_; // of the frame's samples, by their index
    std::vector<shared::LightRow> rows_;     // of those that refine
    // What is summed, piece by piece: one group of the others after another, then the frame's samples. The kernel for
    // the first is compiled where that begins, in a preparation.
    bool own_ = false;
    std::uint32_t group_begin_ = 0, group_end_ = 0, largest_group_ = 0;
    std::uint32_t piece_ = 0;  // the next one
    float fixed_point_ = 1.0f; // of the sums of those that refine: steps per W/m2
    float share_ = 0.0f;
    std::uint64_t texels_ = 0;
    NearbyLight nearby_;
    // Of the frame.
    LightMapJobs jobs_;
    std::vector<shared::LightRow> job_rows_; // that they are of
    bool sums_own_ = false, draws_maps_ = false, divides_ = false;
};

} // namespace sunfleck::gi

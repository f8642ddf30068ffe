// The many-light system's lighting of pixels (thesis sec. 4.3): lists of light samples (VPLs) by tile from the
// visibility database, and light maps, for the stages of low_resolution/. Beyond the thesis: baked light, so that what
// static geometry lets pass is evaluated once, and by pixel only where it is rough or a mover is in the way.
//
// The thesis merges objects and samples into render passes (sec. 4.3.5). Here a dispatch handles all tiles, each with
// its own two lists; see pass_optimisation.h for the passes that the thesis's renderer would need.
#pragma once

#include "engine/gpu/compute_pass.h"
#include "gi_module/low_resolution/low_resolution.h"
#include "gi_module/many_light/baked_light.h"
#include "gi_module/many_light/light_maps.h"
#include "gi_module/many_light/many_light_scene.h"
#include "gi_module/many_light/refined_light.h"
#include "gi_module/many_light/surface_tables.h"
#include "gi_module/shadows/shadow_maps.h"
#include "gi_module/transport/light_batch.h"

namespace sunfleck::gi {

struct ManyLightOptions {
    bool shadows = true;
    bool filter = false;
    bool visibility = true; // off: every sample is tested at every pixel
    bool light_maps = true;
    bool baked_light = true;                       // the static shadow maps of all samples are kept and complete
    bool static_maps_changed = false;              // one of them is redrawn in this frame
    bool bake_in_portions = false;                 // also at first: no frame may take long
    std::uint32_t refinement_budget = 0xffffffffu; // FrameInput::refinement_budget
    bool simplified_movers = false;                // in the maps
    bool stale_maps = false;                       // some map shows movers where they were: see LightRow::bitangent
    std::uint32_t show = shared::show_nothing;     // false colours in place of the irradiance
};

// What the frame's passes read besides. Must live until the graph was executed, but for the spans.
struct ManyLightInput {
    const ShadowMaps& maps;
    std::span<const LightBatch> batches;
    std::span<const std::uint32_t> map_ages; // by sample, frames that its map is out of date
};

class ManyLight {
public:
    static Result<std::unique_ptr<ManyLight>> create(gpu::Device& device, gpu::PipelineStore& pipelines);
    ~ManyLight();

    // Follows the database; call once a frame before add_passes.
    Status update(const ManyLightScene& scene, const RefinedLightScene& refined, const ManyLightOptions& options,
                  gpu::FrameResources& resources);
    // Whether light is refined in this frame, if only in part.
    bool refines() const { return baked_light_->in_use() && refined_light_->share() > 0.0f; }
    // Samples; 0: all is shown as it will stay.
    std::uint64_t refinement_waiting() const {
        return refined_light_->waiting() + (refinement_shows() && refined_light_->waiting() == 0 ? 1 : 0);
    }
    // What is shown takes it over in this frame, or has in the last.
    bool refinement_shows() const {
        return refines() && (refined_light_->share() < 1.0f || baked_light_->marks_again() || marked_again_);
    }
    // Adds the passes that bring tables, light maps and baked light up to date.
    Status add_passes(gpu::FrameGraph& graph, const ManyLightInput& input, const ManyLightOptions& options,
                      gpu::FrameResources& resources);
    // Of its lists, for LowResolutionFrame. After add_passes.
    std::uint64_t bytes_per_group() const { return std::uint64_t(list_stride_) * 4; }
    // Adds the passes that light a stage's pixels. It lists them itself, so it must be the first contributor.
    Status light(const PixelStage& stage, gpu::FrameResources& resources);

    // What was uploaded and summed did not reach the GPU, or is not known to have: the next update does all of it
    // again.
    void restart();

    const LightMaps& light_maps() const { return *light_maps_; }
    const BakedLight& baked_light() const { return *baked_light_; }
    const RefinedLight& refined_light() const { return *refined_light_; }
    std::uint64_t memory_bytes() const;

private:
    struct Frame; // what the passes of one frame share
    enum class Phase : std::uint32_t {
        plain = shared::phase_plain,
        rough = shared::phase_rough,
        baked = shared::phase_baked
    };

    ManyLight(gpu::Device& device, gpu::PipelineStore& pipelines) : device_(device), pipelines_(pipelines) {}
    shared::ManyLightConstants make_constants(const shared::LowResolutionConstants& low) const;
    Status make_buffers(const shared::ManyLightConstants& constants, gpu::FrameResources& resources);
    Status make_buffer(gpu::Buffer& buffer, const char* name, std::uint64_t bytes, VkBufferUsageFlags usage,
                       gpu::FrameResources& resources);
    Result<const gpu::Pipeline*> pipeline(const char* shader, std::vector<std::uint32_t> specialization);
    void dispatch(gpu::ComputePass& pass, const Frame& frame, Phase phase, std::uint32_t command) const;
    Status add_gather(const Frame& frame);
    Status add_lighting(Frame& frame);
    Status add_rough_list(Frame& frame);
    Status add_classify(const Frame& frame, Phase phase, const LightBatch& batch, bool first);
    Status add_classify_baked(const Frame& frame, const LightBatch& batch);
    Status add_light(const Frame& frame, Phase phase, const LightBatch& batch, bool last);
    Status add_show(const Frame& frame, gpu::FrameResources& resources);

    gpu::Device& device_;
    gpu::PipelineStore& pipelines_;
    std::unique_ptr<LightMaps> light_maps_;
    std::unique_ptr<BakedLight> baked_light_;
    std::unique_ptr<RefinedLight> refined_light_;
    SurfaceTables tables_;
    bool baked_with_filter_ = false;
    bool marked_again_ = false; // in the last update, or before it
    std::vector<shared::NodeRow> node_rows_;
    std::uint32_t words_per_row_ = 0, state_words_ = 0, flag_words_ = 0, first_mover_ = 0, mover_count_ = 0;
    gpu::UploadSlice movers_; // spheres
    VkSampler sampler_ = VK_NULL_HANDLE;
    const scene::GpuScene* gpu_scene_ = nullptr;
    gpu::Buffer nodes_, ratios_, local_nodes_, entries_, counts_, block_groups_, rough_entries_, rough_commands_;
    gpu::Buffer unused_texels_, unused_words_;
    // Of the frame, from add_passes on.
    ManyLightOptions options_;
    const ShadowMaps* maps_ = nullptr;
    std::vector<LightBatch> batches_;
    std::vector<std::uint32_t> map_ages_;
    std::uint32_t list_stride_ = 1; // samples of the largest batch
};

} // namespace sunfleck::gi

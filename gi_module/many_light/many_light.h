// The many-light system's lighting of pixels (thesis sec. 4.3): lists of samples by tile from the visibility database,
// light maps, a low-resolution pass, reconstruction, and repair at full resolution. Beyond the thesis: baked light, so
// that what static geometry lets pass is evaluated once, and by pixel only where it is rough or a mover is in the way.
//
// The thesis merges objects and samples into render passes (sec. 4.3.5). Here a dispatch handles all tiles, each with
// its own two lists; see pass_optimisation.h for the passes that the thesis's renderer would need.
#pragma once

#include "engine/gpu/compute_pass.h"
#include "engine/gpu/readback_ring.h"
#include "gi_module/many_light/baked_light.h"
#include "gi_module/many_light/light_maps.h"
#include "gi_module/many_light/surface_tables.h"
#include "gi_module/shadows/shadow_maps.h"
#include "gi_module/transport/g_buffer.h"
#include "gi_module/transport/light_batch.h"

namespace sunfleck::gi {

struct ManyLightOptions {
    bool shadows = true;
    bool filter = false;
    bool visibility = true; // off: every sample is tested at every pixel
    bool light_maps = true;
    bool baked_light = true;          // the static shadow maps of all samples are kept and complete
    bool static_maps_changed = false; // one of them is redrawn in this frame
    std::uint32_t scale = 4;          // of the low-resolution pass: 1 (off), 2, 4 or 8
    float contrast = 0.3f;
    float normal_degrees = 12.0f;
    bool simplified_movers = false;            // in the maps
    bool stale_maps = false;                   // some map shows movers where they were: see LightRow::bitangent
    std::uint32_t show = shared::show_nothing; // false colours in place of the irradiance
};

// Of the newest frame that is complete on the GPU.
struct ManyLightCounters {
    std::uint64_t pixels_low_resolution = 0;
    std::uint64_t pixels_repaired = 0;
    std::uint64_t pixels_not_repaired =
        0; // wanted it, but the lists were full: they took their nearest neighbour's light
    std::uint64_t serial = 0;
};

class ManyLight {
public:
    static Result<std::unique_ptr<ManyLight>> create(gpu::Device& device, gpu::PipelineStore& pipelines);
    ~ManyLight();

    // Follows the database; call once a frame before add_passes.
    Status update(VisibilityDatabase& database, const CurvedCharts& curved, const scene::GpuScene& scene,
                  std::span<const LightSample> samples, std::span<const shared::LightRow> rows,
                  const ManyLightOptions& options, std::uint64_t serial, std::uint64_t completed_serial,
                  gpu::FrameResources& resources);
    // Adds the frame's passes, which write all of `output`. `map_ages`: by sample, frames that its map is out of date.
    Status add_passes(gpu::FrameGraph& graph, const GBufferInput& g_buffer, const gpu::UploadSlice& camera,
                      const ShadowMaps& maps, std::span<const LightBatch> batches,
                      std::span<const std::uint32_t> map_ages, const ManyLightOptions& options,
                      gpu::FrameResources& resources, gpu::ResourceId output);

    const ManyLightCounters& counters() const { return counters_; }
    const LightMaps& light_maps() const { return *light_maps_; }
    const BakedLight& baked_light() const { return *baked_light_; }
    std::uint64_t memory_bytes() const;

private:
    struct Frame; // what the passes of one frame share
    enum class Stage { low_resolution, repair };
    enum class Phase : std::uint32_t {
        plain = shared::phase_plain,
        rough = shared::phase_rough,
        baked = shared::phase_baked
    };

    ManyLight(gpu::Device& device, gpu::PipelineStore& pipelines)
        : device_(device), pipelines_(pipelines),
          readback_(device, "repair counters", VK_BUFFER_USAGE_TRANSFER_DST_BIT) {}
    shared::ManyLightConstants make_constants(const GBufferInput& g_buffer, const ShadowMaps& maps,
                                              std::span<const LightBatch> batches,
                                              const ManyLightOptions& options) const;
    Status make_buffers(const shared::ManyLightConstants& constants, gpu::FrameResources& resources);
    Status make_buffer(gpu::Buffer& buffer, const char* name, std::uint64_t bytes, VkBufferUsageFlags usage,
                       gpu::FrameResources& resources, VkFormat texel_format = VK_FORMAT_UNDEFINED);
    Result<const gpu::Pipeline*> pipeline(const char* shader, std::vector<std::uint32_t> specialization);
    // What a pass is called in timings and captures.
    static std::string pass_name(const char* low_resolution, const char* repair, Stage stage, Phase phase);
    Status add_gather(const Frame& frame, Stage stage);
    Status add_lighting(Frame& frame, Stage stage, std::span<const LightBatch> batches);
    Status add_rough_list(Frame& frame, Stage stage);
    Status add_classify(const Frame& frame, Stage stage, Phase phase, const LightBatch& batch, bool first);
    Status add_classify_baked(const Frame& frame, Stage stage, const LightBatch& batch);
    Status add_light(const Frame& frame, Stage stage, Phase phase, const LightBatch& batch, bool last);
    Status add_reconstruction(const Frame& frame);
    Status add_compaction(const Frame& frame);
    Status add_counters(const Frame& frame);
    Status add_show(const Frame& frame, std::span<const std::uint32_t> map_ages, gpu::FrameResources& resources);
    void dispatch(gpu::ComputePass& pass, Stage stage, Phase phase, std::uint32_t command, std::uint32_t groups) const;
    void collect(std::uint64_t completed_serial);

    gpu::Device& device_;
    gpu::PipelineStore& pipelines_;
    std::unique_ptr<LightMaps> light_maps_;
    std::unique_ptr<BakedLight> baked_light_;
    SurfaceTables tables_;
    std::vector<shared::NodeRow> node_rows_;
    std::uint64_t node_rows_generation_ = 0;
    std::uint32_t words_per_row_ = 0, state_words_ = 0, flag_words_ = 0, first_mover_ = 0, mover_count_ = 0;
    gpu::UploadSlice movers_; // spheres
    VkSampler sampler_ = VK_NULL_HANDLE;
    gpu::Buffer pixels_, nodes_, slots_, sums_, entries_, counts_, cell_masks_, block_groups_, commands_,
        rough_entries_, rough_commands_, picture_, unused_texels_;
    gpu::ReadbackRing readback_; // tag: pixels of the low-resolution picture
    std::uint64_t serial_ = 0, completed_serial_ = 0;
    ManyLightCounters counters_;
};

} // namespace sunfleck::gi

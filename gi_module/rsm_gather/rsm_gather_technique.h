// Light gathered from reflective shadow maps as a technique of gi::System: `rsm_gather`.
#pragma once

#include "engine/gpu/uploaded_buffer.h"
#include "gi_module/rsm_gather/gather_maps.h"
#include "gi_module/technique.h"

namespace sunfleck::gi {

class RsmGatherTechnique final : public Technique {
public:
    static Result<std::unique_ptr<Technique>> create(gpu::Device& device, gpu::PipelineStore& pipelines);
    ~RsmGatherTechnique() override;

    Status update(const SceneView& scene, Services& services, CellSet cells) override;
    Status add_passes(gpu::FrameGraph& graph, Services& services, LightTarget& target) override;
    Status light_pixels(const PixelStage& stage, Services& services) override;
    void report(Report& report) const override;

    // Of the last frame.
    const GatherMaps& maps() const { return maps_; }

private:
    RsmGatherTechnique(gpu::Device& device, gpu::PipelineStore& pipelines) : device_(device), pipelines_(pipelines) {}
    Status upload(gpu::FrameGraph& graph, Services& services);
    Status add_batch(const PixelStage& stage, std::span<const shared::GatherMapRow> rows, bool to_image,
                     gpu::FrameResources& resources);

    gpu::Device& device_;
    gpu::PipelineStore& pipelines_;
    VkSampler sampler_ = VK_NULL_HANDLE;
    GatherMaps maps_;
    float scale_ = 1.0f; // of the light, FrameInput::indirect_scale
    gpu::UploadedBuffer places_, lights_;
    gpu::UploadSlice pattern_;
    std::uint64_t uploaded_ = 0; // version of the maps
};

} // namespace sunfleck::gi

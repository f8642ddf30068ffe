// Glossy reflection as a technique of gi::System: `gloss`.
#pragma once

#include "gi_module/technique.h"
#include "gi_module/transport/light_batch.h"

namespace sunfleck::gi {

class GlossTechnique final : public Technique {
public:
    static Result<std::unique_ptr<Technique>> create(gpu::Device& device, gpu::PipelineStore& pipelines);
    ~GlossTechnique() override;

    Status update(const SceneView& scene, Services& services, CellSet cells) override;
    // Writes the glossy pixels of LightTarget::specular.
    Status add_passes(gpu::FrameGraph& graph, Services& services, LightTarget& target) override;
    void report(Report& report) const override;

private:
    GlossTechnique(gpu::Device& device, gpu::PipelineStore& pipelines) : device_(device), pipelines_(pipelines) {}
    struct Pass;
    Status grow_sums(std::uint64_t pixels, gpu::FrameResources& resources);
    Result<const gpu::Pipeline*> kernel(const LightBatch& batch, const Services& services,
                                        const GBufferInput& g_buffer) const;
    Status add_batches(const Pass& pass, std::span<const LightBatch> batches, bool first, bool last);

    gpu::Device& device_;
    gpu::PipelineStore& pipelines_;
    VkSampler sampler_ = VK_NULL_HANDLE;
    gpu::Buffer sums_, no_texels_;
    CellSet cells_;
    PixelArea area_;
};

} // namespace sunfleck::gi

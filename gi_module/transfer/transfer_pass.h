// Draws movers with their precomputed transfer lighting into the technique's target.
#pragma once

#include "engine/gpu/frame_graph.h"
#include "engine/gpu/pipeline.h"
#include "gi_module/technique.h"
#include "gi_module/transfer/transfer_lighting.h"

namespace sunfleck::gi {

class TransferPass {
public:
    // The device and the pipelines must outlive it.
    static Result<std::unique_ptr<TransferPass>> create(gpu::Device& device, gpu::PipelineStore& pipelines);
    ~TransferPass();

    // Draws the movers into the target where the G-buffer shows them, and sets its area. `draws` must outlive the
    // execution of the graph.
    void add_passes(gpu::FrameGraph& graph, const std::vector<TransferDraw>& draws, LightTarget& target);

private:
    explicit TransferPass(gpu::Device& device) : device_(device) {}
    Status draw(gpu::PassContext& context, const LightTarget& target, const std::vector<TransferDraw>& draws) const;

    gpu::Device& device_;
    VkSampler sampler_ = VK_NULL_HANDLE;
    const gpu::Pipeline* draw_ = nullptr;
};

} // namespace sunfleck::gi

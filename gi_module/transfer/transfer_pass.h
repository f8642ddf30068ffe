// Puts the light of movers with precomputed transfer into the irradiance image.
#pragma once

#include "engine/gpu/frame_graph.h"
#include "engine/gpu/pipeline.h"
#include "gi_module/transfer/transfer_lighting.h"
#include "gi_module/transport/g_buffer.h"

namespace sunfleck::gi {

class TransferPass {
public:
    // The device and the pipelines must outlive it.
    static Result<std::unique_ptr<TransferPass>> create(gpu::Device& device, gpu::PipelineStore& pipelines);
    ~TransferPass();

    // Replaces `output` where the G-buffer shows one of the movers. After the passes that write the rest of it.
    // `camera` holds a CameraRow; `draws` must live until the graph was executed.
    Status add_passes(gpu::FrameGraph& graph, const scene::GpuScene& scene, const GBufferInput& g_buffer,
                      const gpu::UploadSlice& camera, const std::vector<TransferDraw>& draws, gpu::ResourceId output);

private:
    explicit TransferPass(gpu::Device& device) : device_(device) {}
    Status draw(gpu::PassContext& context, const scene::GpuScene& scene, const GBufferInput& g_buffer,
                const gpu::UploadSlice& camera, const std::vector<TransferDraw>& draws, gpu::ResourceId target,
                const VkRect2D& area) const;

    gpu::Device& device_;
    VkSampler sampler_ = VK_NULL_HANDLE;
    const gpu::Pipeline* draw_ = nullptr;
    const gpu::Pipeline* merge_ = nullptr;
};

} // namespace sunfleck::gi

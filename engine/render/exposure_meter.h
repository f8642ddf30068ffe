// What a light meter in the camera sees: the picture's luminance at a grid of points, read back frames later.
#pragma once

#include "engine/gpu/readback_ring.h"
#include "engine/render/composition.h"

namespace sunfleck::render {

class ExposureMeter {
public:
    static Result<std::unique_ptr<ExposureMeter>> create(gpu::Device& device, gpu::PipelineStore& pipelines);
    ~ExposureMeter();

    // Measures this frame, without glossy light. `serial`: of the frame; `completed`: frames that the GPU has finished.
    struct Frame {
        std::uint64_t serial, completed;
    };
    Status add(gpu::FrameGraph& graph, const scene::GpuScene& scene, const GBuffer& g_buffer,
               const CompositionInput& input, const gpu::UploadSlice& camera, Frame frame);

    // Radiance, W/(sr m2), luminance-weighted, of the newest finished frame that was measured and not collected before;
    // empty: there is none. 0: a point that has no light of its own. Valid until the next call of add.
    std::span<const float> collect(std::uint64_t completed);

private:
    explicit ExposureMeter(gpu::Device& device)
        : device_(device), points_(device, "exposure meter", VK_BUFFER_USAGE_STORAGE_BUFFER_BIT) {}

    gpu::Device& device_;
    gpu::ReadbackRing points_;
    const gpu::Pipeline* kernels_[2][2] = {}; // [emission has an image][the sky has a picture]
    VkSampler sampler_ = VK_NULL_HANDLE;
};

} // namespace sunfleck::render

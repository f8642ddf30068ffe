// Blended surfaces are drawn at a share of the pixels, so that each pixel shows one surface and light is found for it
// as for any other. In the picture this pass makes them what they are.
#pragma once

#include "engine/render/g_buffer.h"

namespace sunfleck::render {

class StipplePass {
public:
    static Result<StipplePass> create(gpu::Device& device, gpu::PipelineStore& pipelines);
    // Both are pictures of 8 bits a channel and of the G-buffer's size; `target`, a storage image, is written whole.
    // Pixels that show neither a stippled surface nor, beside one, what lies behind it are copied.
    void add(gpu::FrameGraph& graph, const GBuffer& g_buffer, gpu::ResourceId picture, gpu::ResourceId target) const;
    void destroy(gpu::Device& device);

private:
    const gpu::Pipeline* kernel_ = nullptr;
    VkSampler sampler_ = VK_NULL_HANDLE;
};

} // namespace sunfleck::render

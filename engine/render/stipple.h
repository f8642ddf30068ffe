// Blended surfaces are drawn at a share of the pixels, so that each pixel shows one surface and light is found for it
// as for any other. In the picture this pass makes them what they are.
#pragma once

#include "engine/render/g_buffer.h"

namespace sunfleck::render {

// Of a picture, in pixels; empty if `width` is 0.
struct PixelRectangle {
    std::int32_t x = 0, y = 0;
    std::uint32_t width = 0, height = 0;
};

// What StipplePass may change in the picture of this camera, whose row must be that of the scene's last update.
PixelRectangle stippled_rectangle(const scene::GpuScene& scene, const shared::CameraRow& camera);

class StipplePass {
public:
    static Result<StipplePass> create(gpu::Device& device, gpu::PipelineStore& pipelines);
    // `picture`: of `format`, with 8 bits a channel, and of the G-buffer's size. Only the rectangle is looked at, and
    // in it pixels that show neither a stippled surface nor, beside one, what lies behind it stay as they are.
    void add(gpu::FrameGraph& graph, const GBuffer& g_buffer, const PixelRectangle& rectangle, gpu::ResourceId picture,
             VkFormat format) const;
    void destroy(gpu::Device& device);

private:
    const gpu::Pipeline* kernel_ = nullptr;
    VkSampler sampler_ = VK_NULL_HANDLE;
};

} // namespace sunfleck::render

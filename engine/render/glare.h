// Glare: the share of the light of lamps and sky that a lens, or an eye, scatters on its way. It falls off with the
// square of the angle, as the eye's does from about a degree on (CIE 146, 2002): every octave of distance gets as much
// of it, which are the levels of a pyramid. What is scattered is missing where it came from, so no energy is added.
// Lit surfaces are left out: they are no brighter than their surroundings, and lose as much as they receive.
#pragma once

#include "engine/render/composition.h"

namespace sunfleck::render {

class GlarePass {
public:
    static Result<GlarePass> create(gpu::Device& device, gpu::PipelineStore& pipelines);
    // Image of the scattered light (CompositionInput::glare), from the geometry's surfaces and the sky of `input`.
    gpu::ResourceId add(gpu::FrameGraph& graph, const scene::GpuScene& scene, const GBuffer& g_buffer,
                        const CompositionInput& input, const gpu::UploadSlice& camera) const;
    void destroy(gpu::Device& device);

private:
    void spread(gpu::FrameGraph& graph, gpu::ResourceId fine, gpu::ResourceId coarse, gpu::ResourceId target) const;

    const gpu::Pipeline* source_[2][2] = {}; // [emission has an image][the sky has a picture]
    const gpu::Pipeline* halve_ = nullptr;
    const gpu::Pipeline* add_ = nullptr;
    VkSampler nearest_ = VK_NULL_HANDLE, linear_ = VK_NULL_HANDLE;
};

} // namespace sunfleck::render

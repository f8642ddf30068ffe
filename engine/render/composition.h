// Albedo times irradiance plus emission, exposure, tone curve; and the views that show one ingredient.
#pragma once

#include "engine/render/composition_shared.h"
#include "engine/render/g_buffer.h"
#include "engine/render/sky.h"

namespace sunfleck::render {

struct CompositionInput {
    gpu::ResourceId irradiance; // W/m2, without albedo
    std::uint32_t view = shared::view_final;
    bool tone_map = true;
    float ev100 = 8.0f;
    vec3 sky{0.0f}; // radiance where nothing is hit
    // Its picture, which `sky` is multiplied by, if it has one.
    const SkyImage* sky_image = nullptr;
    float sky_rotation = 0.0f;
};

class CompositionPass {
public:
    static Result<CompositionPass> create(gpu::Device& device, gpu::PipelineStore& pipelines);
    // Writes all of `output`, a storage image with four channels.
    void add(gpu::FrameGraph& graph, const scene::GpuScene& scene, const GBuffer& g_buffer,
             const CompositionInput& input, const gpu::UploadSlice& camera, gpu::ResourceId output) const;
    void destroy(gpu::Device& device);

private:
    // [the final tone-mapped picture only][emission has an image][the sky has a picture]
    const gpu::Pipeline* pipelines_[2][2][2] = {};
    VkSampler sampler_ = VK_NULL_HANDLE;
};

} // namespace sunfleck::render

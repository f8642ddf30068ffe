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
    static Result<CompositionPass> create(gpu::Device& device, gpu::PipelineStore& pipelines, VkFormat display_format);
    // Writes all of `output`: a colour attachment of `display_format` for the final tone-mapped picture, else a storage
    // image with four channels.
    void add(gpu::FrameGraph& graph, const scene::GpuScene& scene, const GBuffer& g_buffer,
             const CompositionInput& input, const gpu::UploadSlice& camera, gpu::ResourceId output) const;
    void destroy(gpu::Device& device);

private:
    void add_final(gpu::FrameGraph& graph, const scene::GpuScene& scene, const GBuffer& g_buffer,
                   const CompositionInput& input, const gpu::UploadSlice& camera, gpu::ResourceId output) const;
    void add_view(gpu::FrameGraph& graph, const scene::GpuScene& scene, const GBuffer& g_buffer,
                  const CompositionInput& input, const gpu::UploadSlice& camera, gpu::ResourceId output) const;
    Status draw_emission(gpu::PassContext& context, const scene::GpuScene& scene, const GBuffer& g_buffer,
                         gpu::ResourceId irradiance, const gpu::UploadSlice& camera, float exposure) const;

    // [emission has an image][the sky has a picture]
    const gpu::Pipeline* views_[2][2] = {};
    const gpu::Pipeline* final_[2][2] = {};
    const gpu::Pipeline* emission_ = nullptr;
    VkSampler sampler_ = VK_NULL_HANDLE;
};

} // namespace sunfleck::render

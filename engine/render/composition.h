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
    bool alpha_is_brightness = false; // of the final tone-mapped picture, for AntialiasingPass; else alpha is 1
    float ev100 = 8.0f;
    vec3 sky{0.0f}; // radiance where nothing is hit
    // Its picture, which `sky` is multiplied by, if it has one.
    const SkyImage* sky_image = nullptr;
    float sky_rotation = 0.0f;
    // Of the final tone-mapped picture: what is scattered (GlarePass), and the share of what shines that is.
    gpu::ResourceId glare;
    float glare_share = 0.0f;
    // Light of glossy pixels: rgb: radiance that facets reflect, W/(sr m2); a: share of the base's light that leaves
    // it through the coat. Not valid: all is matt.
    gpu::ResourceId specular;
};
shared::CompositionConstants composition_constants(const GBuffer& g_buffer, const CompositionInput& input);

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
    // One triangle over all of the picture.
    Status draw_all(gpu::PassContext& context, const gpu::Pipeline& kernel, const GBuffer& g_buffer,
                    const CompositionInput& input, const gpu::UploadSlice& camera) const;
    // Another image stands in where there is none.
    gpu::Binding glare_binding(gpu::PassContext& context, const GBuffer& g_buffer, const CompositionInput& input) const;
    Status draw_emission(gpu::PassContext& context, const scene::GpuScene& scene, const GBuffer& g_buffer,
                         const CompositionInput& input, const gpu::UploadSlice& camera) const;

    const gpu::Pipeline* views_[2][2] = {};    // [emission has an image][the sky has a picture]
    const gpu::Pipeline* final_[2][2][2] = {}; // [emission has an image][alpha is brightness][glare]
    const gpu::Pipeline* emission_[2][2] = {}; // [alpha is brightness][glare]
    // [alpha is brightness][glare]. A picture of the sky is drawn where it shows, by a depth test: looked up for every
    // pixel, it takes a CPU device as long as all the rest.
    const gpu::Pipeline* sky_[2][2] = {};
    VkSampler sampler_ = VK_NULL_HANDLE, linear_ = VK_NULL_HANDLE;
};

} // namespace sunfleck::render

#include "engine/render/composition.h"

#include "engine/render/tone_map.h"

namespace sunfleck::render {

Result<CompositionPass> CompositionPass::create(gpu::Device& device, gpu::PipelineStore& pipelines) {
    CompositionPass pass;
    gpu::ComputeDescription description;
    description.shader = "engine/render/composition.comp";
    description.bindings.assign(7, gpu::BindingKind::sampled_image);
    description.bindings.push_back(gpu::BindingKind::storage_buffer);
    description.bindings.push_back(gpu::BindingKind::storage_image);
    description.bindings.push_back(gpu::BindingKind::uniform_buffer);
    description.bindings.push_back(gpu::BindingKind::sampled_image);
    description.push_constant_bytes = sizeof(shared::CompositionConstants);
    for (std::uint32_t variant = 0; variant < 8; ++variant) {
        const std::uint32_t final = variant >> 2, emission = variant >> 1 & 1, sky = variant & 1;
        description.specialization = {final, emission, sky};
        SUNFLECK_ASSIGN(pass.pipelines_[final][emission][sky], pipelines.compute(description));
    }
    VkSamplerCreateInfo sampler{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
    SUNFLECK_VK(device.vk.vkCreateSampler(device.handle(), &sampler, nullptr, &pass.sampler_), "creating a sampler");
    return pass;
}

void CompositionPass::destroy(gpu::Device& device) {
    device.vk.vkDestroySampler(device.handle(), sampler_, nullptr);
    sampler_ = VK_NULL_HANDLE;
}

void CompositionPass::add(gpu::FrameGraph& graph, const scene::GpuScene& scene, const GBuffer& g_buffer,
                          const CompositionInput& input, const gpu::UploadSlice& camera, gpu::ResourceId output) const {
    const gpu::ResourceId inputs[] = {input.irradiance, g_buffer.depth, g_buffer.normals, g_buffer.surface,
                                      g_buffer.albedo,
                                      // bound, but not read, where there is none
                                      g_buffer.motion.valid() ? g_buffer.motion : g_buffer.albedo,
                                      g_buffer.emission.valid() ? g_buffer.emission : g_buffer.albedo};
    auto pass = graph.add_pass("composition");
    for (const gpu::ResourceId id : inputs)
        pass.read(id, gpu::Usage::sampled);
    shared::CompositionConstants constants{};
    constants.view = input.view;
    constants.tone_map = input.tone_map ? 1 : 0;
    constants.exposure = shared::exposure_factor(input.ev100);
    constants.width = g_buffer.width;
    constants.height = g_buffer.height;
    constants.sky_red = input.sky.x;
    constants.sky_green = input.sky.y;
    constants.sky_blue = input.sky.z;
    constants.sky_rotation = input.sky_rotation;
    const bool final = input.view == shared::view_final && input.tone_map;
    const gpu::Pipeline* kernel = pipelines_[final ? 1 : 0][g_buffer.emission.valid() ? 1 : 0]
                                            [input.sky_image != nullptr && *input.sky_image ? 1 : 0];
    pass.write(output, gpu::Usage::storage_write)
        .execute([this, &scene, kernel, output, constants, camera, sky = input.sky_image,
                  inputs = std::vector(std::begin(inputs), std::end(inputs))](gpu::PassContext& context) -> Status {
            std::vector<gpu::Binding> bindings;
            for (const gpu::ResourceId id : inputs)
                bindings.push_back(gpu::Binding::sampled_image(context.graph.view(id), sampler_));
            bindings.push_back(gpu::Binding::slice(scene.rows()));
            bindings.push_back(gpu::Binding::storage_image(context.graph.view(output)));
            bindings.push_back(gpu::Binding::slice(camera));
            // Without a picture something must be bound all the same.
            bindings.push_back(sky != nullptr ? sky->binding() : bindings[4]);
            SUNFLECK_TRY(context.resources.bind(context.commands, *kernel, bindings));
            context.resources.push(context.commands, *kernel, constants);
            context.device.vk.vkCmdDispatch(context.commands, (constants.width + 7) / 8, (constants.height + 7) / 8, 1);
            return {};
        });
}

} // namespace sunfleck::render

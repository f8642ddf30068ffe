#include "engine/render/stipple.h"

#include "engine/gpu/compute_pass.h"

namespace sunfleck::render {

Result<StipplePass> StipplePass::create(gpu::Device& device, gpu::PipelineStore& pipelines) {
    StipplePass pass;
    gpu::ComputeDescription description;
    description.shader = "engine/render/stipple.comp";
    SUNFLECK_ASSIGN(pass.kernel_, pipelines.compute(description));
    const VkSamplerCreateInfo sampler{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
    SUNFLECK_VK(device.vk.vkCreateSampler(device.handle(), &sampler, nullptr, &pass.sampler_), "creating a sampler");
    return pass;
}

void StipplePass::destroy(gpu::Device& device) {
    device.vk.vkDestroySampler(device.handle(), sampler_, nullptr);
    sampler_ = VK_NULL_HANDLE;
}

void StipplePass::add(gpu::FrameGraph& graph, const GBuffer& g_buffer, gpu::ResourceId picture,
                      gpu::ResourceId target) const {
    gpu::ComputePass(graph, "stippled surfaces", *kernel_)
        .sampled(picture, sampler_)
        .sampled(g_buffer.surface, sampler_)
        .sampled(g_buffer.depth, sampler_)
        .storage_write(target)
        .dispatch((g_buffer.width + 7) / 8, (g_buffer.height + 7) / 8);
}

} // namespace sunfleck::render

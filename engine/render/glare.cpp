#include "engine/render/glare.h"

#include "engine/core/divide_up.h"
#include "engine/gpu/compute_pass.h"

#include <algorithm>
#include <string>

namespace sunfleck::render {
namespace {

constexpr VkFormat glare_format = VK_FORMAT_R16G16B16A16_SFLOAT;

std::uint32_t groups(std::uint32_t pixels) {
    return divide_up(pixels, 8);
}

} // namespace

Result<GlarePass> GlarePass::create(gpu::Device& device, gpu::PipelineStore& pipelines) {
    GlarePass pass;
    gpu::ComputeDescription source, spread;
    source.shader = "engine/render/glare_source.comp";
    for (const std::uint32_t emission : {0, 1})
        for (const std::uint32_t sky : {0, 1}) {
            source.specialization = {emission, sky};
            SUNFLECK_ASSIGN(pass.source_[emission][sky], pipelines.compute(source));
        }
    spread.shader = "engine/render/glare_spread.comp";
    spread.specialization = {0};
    SUNFLECK_ASSIGN(pass.halve_, pipelines.compute(spread));
    spread.specialization = {1};
    SUNFLECK_ASSIGN(pass.add_, pipelines.compute(spread));
    VkSamplerCreateInfo info{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
    SUNFLECK_VK(device.vk.vkCreateSampler(device.handle(), &info, nullptr, &pass.nearest_), "creating a sampler");
    info.magFilter = info.minFilter = VK_FILTER_LINEAR;
    info.addressModeU = info.addressModeV = info.addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
    SUNFLECK_VK(device.vk.vkCreateSampler(device.handle(), &info, nullptr, &pass.linear_), "creating a sampler");
    return pass;
}

void GlarePass::destroy(gpu::Device& device) {
    for (VkSampler* sampler : {&nearest_, &linear_}) {
        device.vk.vkDestroySampler(device.handle(), *sampler, nullptr);
        *sampler = VK_NULL_HANDLE;
    }
}

gpu::ResourceId GlarePass::add(gpu::FrameGraph& graph, const scene::GpuScene& scene, const GBuffer& g_buffer,
                               const CompositionInput& input, const gpu::UploadSlice& camera) const {
    const bool emission = g_buffer.emission.valid(), sky = input.sky_image != nullptr && *input.sky_image;
    const auto image = [&](std::uint32_t level) {
        const std::uint32_t side = shared::glare_block << level;
        return graph.create_image("glare " + std::to_string(level), glare_format,
                                  std::max(divide_up(g_buffer.width, side), 1u),
                                  std::max(divide_up(g_buffer.height, side), 1u));
    };
    gpu::ResourceId levels[shared::glare_levels];
    for (std::uint32_t level = 0; level < shared::glare_levels; ++level)
        levels[level] = image(level);
    const gpu::ImageDescription& size = graph.description(levels[0]);
    gpu::ComputePass pass(graph, "glare source", *source_[emission][sky]);
    // What there is not must be bound all the same; the surfaces stand in for it, unread.
    pass.sampled(g_buffer.surface, nearest_).sampled(emission ? g_buffer.emission : g_buffer.albedo, nearest_);
    if (input.sky_image != nullptr)
        pass.constant(input.sky_image->binding());
    else
        pass.sampled(g_buffer.albedo, nearest_);
    pass.uniform(camera)
        .storage_read(scene.rows())
        .storage_write(levels[0])
        .push(composition_constants(g_buffer, input))
        .dispatch(groups(size.width), groups(size.height));
    for (std::uint32_t level = 1; level < shared::glare_levels; ++level)
        spread(graph, levels[level - 1], {}, levels[level]);
    gpu::ResourceId sum = levels[shared::glare_levels - 1];
    for (std::uint32_t level = shared::glare_levels - 1; level-- > 0;) {
        const gpu::ResourceId target = image(level);
        spread(graph, levels[level], sum, target);
        sum = target;
    }
    return sum;
}

void GlarePass::spread(gpu::FrameGraph& graph, gpu::ResourceId fine, gpu::ResourceId coarse,
                       gpu::ResourceId target) const {
    const gpu::ImageDescription size = graph.description(target);
    gpu::ComputePass(graph, "glare", coarse.valid() ? *add_ : *halve_)
        .sampled(fine, linear_)
        .sampled(coarse.valid() ? coarse : fine, linear_)
        .storage_write(target)
        .push(glm::ivec2(int(size.width), int(size.height)))
        .dispatch(groups(size.width), groups(size.height));
}

} // namespace sunfleck::render

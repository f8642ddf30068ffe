#include "gi_module/light_sum/light_sum.h"

#include "engine/core/divide_up.h"
#include "engine/gpu/compute_pass.h"

namespace sunfleck::gi {
namespace {

std::uint32_t groups(std::uint32_t pixels) {
    return divide_up(pixels, shared::light_sum_side);
}

} // namespace

Result<std::unique_ptr<LightSum>> LightSum::create(gpu::Device& device, gpu::PipelineStore& pipelines) {
    std::unique_ptr<LightSum> sum(new LightSum(device));
    VkSamplerCreateInfo sampler{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
    SUNFLECK_VK(device.vk.vkCreateSampler(device.handle(), &sampler, nullptr, &sum->sampler_), "creating a sampler");
    gpu::ComputeDescription description;
    description.shader = "gi_module/light_sum/light_sum_16.comp";
    SUNFLECK_ASSIGN(sum->halves_, pipelines.compute(description));
    description.shader = "gi_module/light_sum/light_sum_32.comp";
    SUNFLECK_ASSIGN(sum->floats_, pipelines.compute(description));
    description.shader = "gi_module/light_sum/set_to_zero.comp";
    SUNFLECK_ASSIGN(sum->zeros_, pipelines.compute(description));
    return sum;
}

LightSum::~LightSum() {
    device_.vk.vkDestroySampler(device_.handle(), sampler_, nullptr);
}

Status LightSum::clear(gpu::FrameGraph& graph, const GBufferInput& g_buffer, gpu::ResourceId picture,
                       gpu::FrameResources& resources) {
    SUNFLECK_ASSIGN(const gpu::UploadSlice unused, resources.upload_value(0u));
    return add_pass(graph, g_buffer, g_buffer.depth, picture, unused,
                    {0, 0, g_buffer.width, g_buffer.height, shared::light_sum_clear, 0});
}

void LightSum::set_to_zero(gpu::FrameGraph& graph, gpu::ResourceId image) {
    const gpu::ImageDescription& size = graph.description(image);
    gpu::ComputePass(graph, "specular light clear", *zeros_)
        .storage_write(image)
        .dispatch(groups(size.width), groups(size.height));
}

Status LightSum::add(gpu::FrameGraph& graph, const scene::GpuScene& scene, const GBufferInput& g_buffer,
                     const Layer& layer, gpu::ResourceId picture, gpu::FrameResources& resources) {
    if (layer.area.width == 0 || layer.area.height == 0)
        return {};
    std::vector<std::uint32_t> kinds(std::max<std::size_t>(scene.draws().size(), 1));
    for (const scene::DrawItem& item : scene.draws())
        kinds[item.row] = item.is_static ? shared::receiver_fixed : shared::receiver_mover;
    SUNFLECK_ASSIGN(const gpu::UploadSlice receivers, resources.upload(std::span<const std::uint32_t>(kinds)));
    return add_pass(graph, g_buffer, layer.image, picture, receivers,
                    {layer.area.x, layer.area.y, layer.area.width, layer.area.height,
                     layer.replaces ? shared::light_sum_replace : shared::light_sum_add, layer.receivers});
}

Status LightSum::add_pass(gpu::FrameGraph& graph, const GBufferInput& g_buffer, gpu::ResourceId layer,
                          gpu::ResourceId picture, const gpu::UploadSlice& receivers,
                          const shared::LightSumConstants& constants) {
    const bool clears = constants.mode == shared::light_sum_clear;
    const gpu::Pipeline* kernel =
        graph.description(picture).format == VK_FORMAT_R32G32B32A32_SFLOAT ? floats_ : halves_;
    gpu::ComputePass(graph, clears ? "light clear" : "light sum", *kernel)
        .sampled(g_buffer.depth, sampler_)
        .sampled(g_buffer.surface, sampler_)
        .sampled(layer, sampler_)
        .storage_read(receivers)
        .storage_read_write(picture)
        .push(constants)
        .dispatch(groups(constants.width), groups(constants.height));
    return {};
}

} // namespace sunfleck::gi

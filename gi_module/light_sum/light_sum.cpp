#include "gi_module/light_sum/light_sum.h"

namespace sunfleck::gi {

Result<std::unique_ptr<LightSum>> LightSum::create(gpu::Device& device, gpu::PipelineStore& pipelines) {
    std::unique_ptr<LightSum> sum(new LightSum(device));
    VkSamplerCreateInfo sampler{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
    SUNFLECK_VK(device.vk.vkCreateSampler(device.handle(), &sampler, nullptr, &sum->sampler_), "creating a sampler");
    using enum gpu::BindingKind;
    gpu::ComputeDescription description;
    description.bindings = {sampled_image, sampled_image, sampled_image, storage_buffer, storage_image};
    description.push_constant_bytes = sizeof(shared::LightSumConstants);
    description.shader = "gi_module/light_sum/light_sum_16.comp";
    SUNFLECK_ASSIGN(sum->halves_, pipelines.compute(description));
    description.shader = "gi_module/light_sum/light_sum_32.comp";
    SUNFLECK_ASSIGN(sum->floats_, pipelines.compute(description));
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
    auto pass = graph.add_pass(clears ? "light clear" : "light sum");
    pass.read(g_buffer.depth, gpu::Usage::sampled).read(g_buffer.surface, gpu::Usage::sampled);
    if (!clears)
        pass.read(layer, gpu::Usage::sampled);
    pass.write(picture, clears ? gpu::Usage::storage_write : gpu::Usage::storage_read_write)
        .execute([this, kernel, g_buffer, layer, picture, receivers, constants](gpu::PassContext& context) -> Status {
            const gpu::Binding bindings[] = {
                gpu::Binding::sampled_image(context.graph.view(g_buffer.depth), sampler_),
                gpu::Binding::sampled_image(context.graph.view(g_buffer.surface), sampler_),
                gpu::Binding::sampled_image(context.graph.view(layer), sampler_), gpu::Binding::slice(receivers),
                gpu::Binding::storage_image(context.graph.view(picture))};
            SUNFLECK_TRY(context.resources.bind(context.commands, *kernel, bindings));
            context.resources.push(context.commands, *kernel, constants);
            const auto groups = [](std::uint32_t pixels) {
                return (pixels + shared::light_sum_side - 1) / shared::light_sum_side;
            };
            context.device.vk.vkCmdDispatch(context.commands, groups(constants.width), groups(constants.height), 1);
            return {};
        });
    return {};
}

} // namespace sunfleck::gi

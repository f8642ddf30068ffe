#include "gi_module/g_buffer/conversion.h"

namespace sunfleck::gi {
namespace {

void dispatch(gpu::PassContext& context, std::uint32_t width, std::uint32_t height) {
    const auto groups = [](std::uint32_t pixels) {
        return (pixels + shared::conversion_side - 1) / shared::conversion_side;
    };
    context.device.vk.vkCmdDispatch(context.commands, groups(width), groups(height), 1);
}

std::uint32_t shader_encoding(NormalEncoding encoding) {
    return encoding == NormalEncoding::unsigned_values ? shared::normal_unsigned : shared::normal_signed;
}

} // namespace

Result<std::unique_ptr<GBufferConversion>> GBufferConversion::create(gpu::Device& device,
                                                                     gpu::PipelineStore& pipelines) {
    std::unique_ptr<GBufferConversion> conversion(new GBufferConversion(device, pipelines));
    const VkSamplerCreateInfo sampler{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
    SUNFLECK_VK(device.vk.vkCreateSampler(device.handle(), &sampler, nullptr, &conversion->sampler_),
                "creating a sampler");
    return conversion;
}

GBufferConversion::~GBufferConversion() {
    device_.vk.vkDestroySampler(device_.handle(), sampler_, nullptr);
}

// Made when first needed: most hosts need none.
Result<const gpu::Pipeline*> GBufferConversion::pipeline(const gpu::ComputeDescription& description) {
    const std::pair key(description.shader, description.specialization);
    if (const auto found = made_.find(key); found != made_.end())
        return found->second;
    SUNFLECK_ASSIGN(const gpu::Pipeline* made, pipelines_.compute(description));
    made_[key] = made;
    return made;
}

Result<GBufferInput> GBufferConversion::add_passes(gpu::FrameGraph& graph, const HostGBuffer& host,
                                                   const gpu::UploadSlice& camera) {
    GBufferInput input;
    input.depth = host.depth;
    input.normals = host.normals;
    input.surface = host.surface;
    input.width = host.width;
    input.height = host.height;
    if (!host.mapping.is_identity()) {
        SUNFLECK_ASSIGN(input.depth, convert_depth(graph, host));
    }
    if (host.normal_encoding != NormalEncoding::packed) {
        SUNFLECK_ASSIGN(input.normals, convert_normals(graph, host, input.depth, camera));
    }
    return input;
}

Result<gpu::ResourceId> GBufferConversion::convert_depth(gpu::FrameGraph& graph, const HostGBuffer& host) {
    using enum gpu::BindingKind;
    gpu::ComputeDescription description;
    description.shader = "gi_module/g_buffer/convert_depth.comp";
    description.bindings = {sampled_image, storage_image};
    description.push_constant_bytes = sizeof(shared::DepthConversionConstants);
    SUNFLECK_ASSIGN(const gpu::Pipeline* kernel, pipeline(description));
    const scene::DepthMapping& mapping = host.mapping;
    const shared::DepthConversionConstants constants{mapping.slope, mapping.background, mapping.offset,
                                                     mapping.scale, host.width,         host.height};
    const gpu::ResourceId target = graph.create_image("converted depth", VK_FORMAT_R32_SFLOAT, host.width, host.height);
    graph.add_pass("depth conversion")
        .read(host.depth, gpu::Usage::sampled)
        .write(target, gpu::Usage::storage_write)
        .execute([this, kernel, constants, source = host.depth, target](gpu::PassContext& context) -> Status {
            const gpu::Binding bindings[] = {gpu::Binding::sampled_image(context.graph.view(source), sampler_),
                                             gpu::Binding::storage_image(context.graph.view(target))};
            SUNFLECK_TRY(context.resources.bind(context.commands, *kernel, bindings));
            context.resources.push(context.commands, *kernel, constants);
            dispatch(context, constants.width, constants.height);
            return {};
        });
    return target;
}

Result<gpu::ResourceId> GBufferConversion::convert_normals(gpu::FrameGraph& graph, const HostGBuffer& host,
                                                           gpu::ResourceId depth, const gpu::UploadSlice& camera) {
    const bool has_geometric = host.geometric_normals.valid();
    using enum gpu::BindingKind;
    gpu::ComputeDescription description;
    description.shader = "gi_module/g_buffer/convert_normals.comp";
    description.bindings = {uniform_buffer, sampled_image, sampled_image, sampled_image, storage_image};
    description.push_constant_bytes = sizeof(shared::NormalConversionConstants);
    description.specialization = {shader_encoding(host.normal_encoding),
                                  has_geometric ? shader_encoding(host.geometric_encoding) : shared::normal_missing};
    SUNFLECK_ASSIGN(const gpu::Pipeline* kernel, pipeline(description));
    const shared::NormalConversionConstants constants{host.depth_step * std::abs(host.mapping.scale), host.width,
                                                      host.height};
    const gpu::ResourceId target =
        graph.create_image("converted normals", VK_FORMAT_R32G32_UINT, host.width, host.height);
    const gpu::ResourceId geometric = has_geometric ? host.geometric_normals : host.normals; // bound, but not read
    auto pass = graph.add_pass("normal conversion");
    pass.read(depth, gpu::Usage::sampled).read(host.normals, gpu::Usage::sampled);
    if (has_geometric)
        pass.read(geometric, gpu::Usage::sampled);
    pass.write(target, gpu::Usage::storage_write)
        .execute([this, kernel, constants, camera, depth, shading = host.normals, geometric,
                  target](gpu::PassContext& context) -> Status {
            const gpu::Binding bindings[] = {gpu::Binding::slice(camera),
                                             gpu::Binding::sampled_image(context.graph.view(depth), sampler_),
                                             gpu::Binding::sampled_image(context.graph.view(shading), sampler_),
                                             gpu::Binding::sampled_image(context.graph.view(geometric), sampler_),
                                             gpu::Binding::storage_image(context.graph.view(target))};
            SUNFLECK_TRY(context.resources.bind(context.commands, *kernel, bindings));
            context.resources.push(context.commands, *kernel, constants);
            dispatch(context, constants.width, constants.height);
            return {};
        });
    return target;
}

Status GBufferConversion::add_clear(gpu::FrameGraph& graph, gpu::ResourceId target) {
    gpu::ComputeDescription description;
    description.shader = "gi_module/g_buffer/clear.comp";
    description.bindings = {gpu::BindingKind::storage_image};
    SUNFLECK_ASSIGN(const gpu::Pipeline* kernel, pipeline(description));
    graph.add_pass("clear specular")
        .write(target, gpu::Usage::storage_write)
        .execute([kernel, target](gpu::PassContext& context) -> Status {
            const gpu::Binding bindings[] = {gpu::Binding::storage_image(context.graph.view(target))};
            SUNFLECK_TRY(context.resources.bind(context.commands, *kernel, bindings));
            const gpu::ImageDescription& size = context.graph.description(target);
            dispatch(context, size.width, size.height);
            return {};
        });
    return {};
}

} // namespace sunfleck::gi

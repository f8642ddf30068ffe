#include "gi_module/g_buffer/conversion.h"

#include "engine/core/divide_up.h"
#include "engine/gpu/compute_pass.h"

namespace sunfleck::gi {
namespace {

std::uint32_t groups(std::uint32_t pixels) {
    return divide_up(pixels, shared::conversion_side);
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
    gpu::ComputeDescription description;
    description.shader = "gi_module/g_buffer/convert_depth.comp";
    SUNFLECK_ASSIGN(const gpu::Pipeline* kernel, pipeline(description));
    const scene::DepthMapping& mapping = host.mapping;
    const shared::DepthConversionConstants constants{mapping.slope, mapping.background, mapping.offset,
                                                     mapping.scale, host.width,         host.height};
    const gpu::ResourceId target = graph.create_image("converted depth", VK_FORMAT_R32_SFLOAT, host.width, host.height);
    gpu::ComputePass(graph, "depth conversion", *kernel)
        .sampled(host.depth, sampler_)
        .storage_write(target)
        .push(constants)
        .dispatch(groups(host.width), groups(host.height));
    return target;
}

Result<gpu::ResourceId> GBufferConversion::convert_normals(gpu::FrameGraph& graph, const HostGBuffer& host,
                                                           gpu::ResourceId depth, const gpu::UploadSlice& camera) {
    const bool has_geometric = host.geometric_normals.valid();
    gpu::ComputeDescription description;
    description.shader = "gi_module/g_buffer/convert_normals.comp";
    description.specialization = {shader_encoding(host.normal_encoding),
                                  has_geometric ? shader_encoding(host.geometric_encoding) : shared::normal_missing};
    SUNFLECK_ASSIGN(const gpu::Pipeline* kernel, pipeline(description));
    const shared::NormalConversionConstants constants{host.depth_step * std::abs(host.mapping.scale), host.width,
                                                      host.height};
    const gpu::ResourceId target =
        graph.create_image("converted normals", VK_FORMAT_R32G32_UINT, host.width, host.height);
    const gpu::ResourceId geometric = has_geometric ? host.geometric_normals : host.normals; // bound, but not read
    gpu::ComputePass(graph, "normal conversion", *kernel)
        .uniform(camera)
        .sampled(depth, sampler_)
        .sampled(host.normals, sampler_)
        .sampled(geometric, sampler_)
        .storage_write(target)
        .push(constants)
        .dispatch(groups(host.width), groups(host.height));
    return target;
}

} // namespace sunfleck::gi

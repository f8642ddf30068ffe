#include "gi_module/adaptive_shadows/punctual_kernel.h"

#include "engine/gpu/compute_pass.h"
#include "gi_module/shadows/octahedral_map.h"

namespace sunfleck::gi {

Result<std::unique_ptr<PunctualKernel>> PunctualKernel::create(gpu::Device& device, gpu::PipelineStore& pipelines) {
    std::unique_ptr<PunctualKernel> kernel(new PunctualKernel(device, pipelines));
    const VkSamplerCreateInfo sampler{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
    SUNFLECK_VK(device.vk.vkCreateSampler(device.handle(), &sampler, nullptr, &kernel->sampler_), "creating a sampler");
    // Some drivers need every binding of a set to be alive, used or not.
    gpu::BufferDescription unused;
    unused.name = "unused texels";
    unused.usage = VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT;
    unused.texel_format = VK_FORMAT_R32_UINT;
    SUNFLECK_ASSIGN(kernel->no_texels_, gpu::Buffer::create(device, unused));
    return kernel;
}

PunctualKernel::~PunctualKernel() {
    device_.vk.vkDestroySampler(device_.handle(), sampler_, nullptr);
}

Status PunctualKernel::grow_sums(const PunctualFrame& frame, bool needed, gpu::FrameResources& resources) {
    const VkDeviceSize bytes = needed ? VkDeviceSize(frame.g_buffer.width) * frame.g_buffer.height * sizeof(vec4) : 16;
    if (sums_ && sums_.size() >= bytes)
        return {};
    if (sums_)
        resources.retire(std::move(sums_));
    SUNFLECK_ASSIGN(sums_,
                    gpu::Buffer::create(device_, {"sums of punctual light", bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                                                  gpu::MemoryUse::device, VK_FORMAT_UNDEFINED}));
    return {};
}

Status PunctualKernel::add_passes(const PunctualFrame& frame, std::span<const PunctualBatch> batches,
                                  std::span<const std::uint32_t> table, gpu::FrameResources& resources) {
    // A CPU device reads a light's row once for each invocation; a GPU wants many small invocations instead.
    const std::uint32_t pixels = device_.traits().software ? 8 : 1, columns = 8 * pixels;
    SUNFLECK_TRY(grow_sums(frame, batches.size() > 1, resources));
    SUNFLECK_ASSIGN(const gpu::UploadSlice entries, resources.upload(table));
    for (std::size_t i = 0; i < batches.size(); ++i) {
        gpu::ComputeDescription description;
        description.shader = frame.graph.description(frame.picture).format == VK_FORMAT_R32G32B32A32_SFLOAT
                                 ? "gi_module/adaptive_shadows/punctual_light_32.comp"
                                 : "gi_module/adaptive_shadows/punctual_light_16.comp";
        description.specialization = {batches[i].map_kind,
                                      frame.maps != nullptr ? shared::maps_texel_buffer : shared::maps_none, pixels,
                                      frame.adds ? 1u : 0u};
        description.name = "punctual light";
        SUNFLECK_ASSIGN(const gpu::Pipeline* kernel, pipelines_.compute(description));
        SUNFLECK_ASSIGN(const gpu::UploadSlice lights,
                        resources.allocate(sizeof(shared::TileLight) * shared::lights_per_pass));
        std::memcpy(lights.data, batches[i].lights.data(), sizeof(shared::TileLight) * batches[i].lights.size());
        const shared::PunctualConstants constants{frame.g_buffer.width, frame.g_buffer.height,
                                                  std::uint32_t(batches[i].lights.size()), i == 0 ? 1u : 0u,
                                                  i + 1 == batches.size() ? 1u : 0u};
        gpu::ComputePass(frame.graph, "punctual light", *kernel)
            .uniform(frame.camera)
            .sampled(frame.g_buffer.depth, sampler_)
            .sampled(frame.g_buffer.normals, sampler_)
            .uniform(lights)
            .storage_read(entries)
            .texels(frame.maps != nullptr ? *frame.maps : no_texels_)
            .storage_read_write(sums_)
            .storage_read_write(frame.picture)
            .push(constants)
            .dispatch((constants.width + columns - 1) / columns, (constants.height + 7) / 8);
    }
    return {};
}

} // namespace sunfleck::gi

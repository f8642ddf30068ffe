#include "gi_module/adaptive_shadows/punctual_kernel.h"

#include "engine/core/divide_up.h"
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

Status PunctualKernel::grow_buffers(std::size_t blocks, gpu::FrameResources& resources) {
    if (masks_ && masks_.size() >= blocks * sizeof(std::uint32_t))
        return {};
    const auto make = [&](gpu::Buffer& buffer, const char* name, VkDeviceSize bytes,
                          VkBufferUsageFlags more) -> Status {
        if (buffer)
            resources.retire(std::move(buffer));
        SUNFLECK_ASSIGN(buffer, gpu::Buffer::create(device_, {name, bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | more,
                                                              gpu::MemoryUse::device, VK_FORMAT_UNDEFINED}));
        return {};
    };
    SUNFLECK_TRY(make(masks_, "lights of blocks", blocks * sizeof(std::uint32_t), 0));
    SUNFLECK_TRY(make(blocks_, "blocks with lights",
                      shared::map_kinds * shared::list_stride(std::uint32_t(blocks)) * sizeof(shared::LitBlock), 0));
    return make(commands_, "punctual light commands", sizeof(VkDispatchIndirectCommand) * shared::map_kinds,
                VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT);
}

shared::PunctualConstants PunctualKernel::constants_of(const PunctualFrame& frame, const PunctualBatch& batch) const {
    shared::PunctualConstants result;
    result.width = frame.g_buffer.width;
    result.height = frame.g_buffer.height;
    result.light_count = std::uint32_t(batch.lights.size());
    result.block_columns = divide_up(result.width, 8 * pixels());
    result.block_count = result.block_columns * divide_up(result.height, shared::block_rows);
    std::copy(batch.kind_lights.begin(), batch.kind_lights.end(), result.kind_lights);
    return result;
}

Status PunctualKernel::add_lists(const PunctualFrame& frame, const PunctualBatch& batch, const gpu::UploadSlice& lights,
                                 bool clears) {
    const shared::PunctualConstants constants = constants_of(frame, batch);
    SUNFLECK_ASSIGN(const gpu::Pipeline* lists, pipelines_.compute({"gi_module/adaptive_shadows/punctual_lists.comp",
                                                                    {pixels(), clears ? 1u : 0u},
                                                                    "punctual lists"}));
    SUNFLECK_ASSIGN(const gpu::Pipeline* blocks,
                    pipelines_.compute({"gi_module/adaptive_shadows/punctual_blocks.comp", {}, "punctual blocks"}));
    gpu::ComputePass(frame.graph, "punctual lists", *lists)
        .uniform(frame.camera)
        .sampled(frame.g_buffer.depth, sampler_)
        .uniform(lights)
        .storage_write(masks_)
        .storage_write(frame.picture)
        .push(constants)
        .dispatch(constants.block_columns, constants.block_count / constants.block_columns);
    gpu::ComputePass(frame.graph, "punctual blocks", *blocks)
        .storage_read(masks_)
        .storage_write(blocks_)
        .storage_write(commands_)
        .push(constants)
        .dispatch(shared::map_kinds);
    return {};
}

Status PunctualKernel::add_light(const PunctualFrame& frame, const PunctualBatch& batch, std::uint32_t map_kind,
                                 const gpu::UploadSlice& lights, const gpu::UploadSlice& table) {
    gpu::ComputeDescription description;
    description.shader = frame.graph.description(frame.picture).format == VK_FORMAT_R32G32B32A32_SFLOAT
                             ? "gi_module/adaptive_shadows/punctual_light_32.comp"
                             : "gi_module/adaptive_shadows/punctual_light_16.comp";
    description.specialization = {map_kind, frame.maps != nullptr ? shared::maps_texel_buffer : shared::maps_none,
                                  pixels()};
    description.name = "punctual light";
    SUNFLECK_ASSIGN(const gpu::Pipeline* kernel, pipelines_.compute(description));
    gpu::ComputePass(frame.graph, "punctual light", *kernel)
        .uniform(frame.camera)
        .sampled(frame.g_buffer.depth, sampler_)
        .sampled(frame.g_buffer.normals, sampler_)
        .uniform(lights)
        .storage_read(table)
        .texels(frame.maps != nullptr ? *frame.maps : no_texels_)
        .storage_read(blocks_)
        .storage_read_write(frame.picture)
        .push(constants_of(frame, batch))
        .dispatch_indirect(commands_, sizeof(VkDispatchIndirectCommand) * map_kind);
    return {};
}

Status PunctualKernel::add_passes(const PunctualFrame& frame, std::span<const PunctualBatch> batches,
                                  std::span<const std::uint32_t> table, gpu::FrameResources& resources) {
    SUNFLECK_TRY(grow_buffers(constants_of(frame, {}).block_count, resources));
    SUNFLECK_ASSIGN(const gpu::UploadSlice entries, resources.upload(table));
    for (const PunctualBatch& batch : batches) {
        SUNFLECK_ASSIGN(const gpu::UploadSlice lights,
                        resources.allocate(sizeof(shared::TileLight) * shared::lights_per_pass));
        std::memcpy(lights.data, batch.lights.data(), sizeof(shared::TileLight) * batch.lights.size());
        SUNFLECK_TRY(add_lists(frame, batch, lights, !frame.adds && &batch == batches.data()));
        for (std::uint32_t kind = 0; kind < shared::map_kinds; ++kind)
            if (batch.kind_lights[kind] != 0)
                SUNFLECK_TRY(add_light(frame, batch, kind, lights, entries));
    }
    return {};
}

} // namespace sunfleck::gi

#include "gi_module/splatting/splat_kernel.h"

#include <algorithm>
#include <cstring>

namespace sunfleck::gi {

Result<std::unique_ptr<SplatKernel>> SplatKernel::create(gpu::Device& device, gpu::PipelineStore& pipelines) {
    std::unique_ptr<SplatKernel> kernel(new SplatKernel(device, pipelines));
    const VkSamplerCreateInfo sampler{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
    SUNFLECK_VK(device.vk.vkCreateSampler(device.handle(), &sampler, nullptr, &kernel->sampler_), "creating a sampler");
    return kernel;
}

SplatKernel::~SplatKernel() {
    device_.vk.vkDestroySampler(device_.handle(), sampler_, nullptr);
}

Status SplatKernel::make_masks(const PixelStage& stage, gpu::FrameResources& resources) {
    const std::uint64_t groups = std::max(stage.constants.group_capacity, stage.constants.group_count);
    if (masks_ && masks_.size() >= groups * bytes_per_group)
        return {};
    if (masks_)
        resources.retire(std::move(masks_));
    SUNFLECK_ASSIGN(masks_, gpu::Buffer::create(device_, {"pixel lights of groups", groups * bytes_per_group,
                                                          VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::MemoryUse::device,
                                                          VK_FORMAT_UNDEFINED}));
    return {};
}

Status SplatKernel::add_passes(const PixelStage& stage, std::span<const shared::PixelLightRow> lights,
                               gpu::FrameResources& resources) {
    if (stage.first)
        SUNFLECK_TRY(stage.low_resolution.list_pixels(stage));
    const bool writes_picture = stage.last && stage.resolves;
    if (lights.empty())
        return writes_picture ? stage.low_resolution.resolve(stage) : Status();
    SUNFLECK_TRY(make_masks(stage, resources));
    for (std::size_t first = 0; first < lights.size(); first += shared::splats_per_batch) {
        const auto batch =
            lights.subspan(first, std::min<std::size_t>(shared::splats_per_batch, lights.size() - first));
        SUNFLECK_ASSIGN(const gpu::UploadSlice rows,
                        resources.allocate(sizeof(shared::PixelLightRow) * shared::splats_per_batch));
        std::memcpy(rows.data, batch.data(), batch.size_bytes());
        const shared::SplattingConstants constants{stage.constants.width, stage.constants.height,
                                                   stage.constants.group_count, std::uint32_t(batch.size())};
        SUNFLECK_TRY(add_lists(stage, rows, constants));
        SUNFLECK_TRY(add_light(stage, rows, constants, writes_picture && first + batch.size() == lights.size()));
    }
    return {};
}

Status SplatKernel::add_lists(const PixelStage& stage, const gpu::UploadSlice& rows,
                              const shared::SplattingConstants& constants) {
    gpu::ComputeDescription description;
    description.shader = "gi_module/splatting/splat_lists.comp";
    description.specialization = {stage.repair};
    SUNFLECK_ASSIGN(const gpu::Pipeline* kernel, pipelines_.compute(description));
    gpu::ComputePass pass(stage.graph, stage.repair ? "repair splat lists" : "splat lists", *kernel);
    pass.uniform(stage.camera)
        .sampled(stage.g_buffer.depth, sampler_)
        .sampled(stage.g_buffer.normals, sampler_)
        .uniform(rows)
        .storage_read(stage.pixels)
        .storage_read(stage.commands)
        .storage_write(masks_)
        .push(constants);
    stage.dispatch(pass, shared::command_packed);
    return {};
}

Status SplatKernel::add_light(const PixelStage& stage, const gpu::UploadSlice& rows,
                              const shared::SplattingConstants& constants, bool to_image) {
    const std::uint32_t lanes = device_.traits().software ? 8 : 64;
    gpu::ComputeDescription description;
    description.shader = "gi_module/splatting/splat_light.comp";
    description.specialization = {shared::pixel_group_size / lanes, lanes, to_image};
    SUNFLECK_ASSIGN(const gpu::Pipeline* kernel, pipelines_.compute(description));
    gpu::ComputePass pass(stage.graph, stage.repair ? "repair splat light" : "splat light", *kernel);
    pass.uniform(stage.camera)
        .sampled(stage.g_buffer.depth, sampler_)
        .sampled(stage.g_buffer.normals, sampler_)
        .uniform(rows)
        .storage_read(stage.pixels)
        .storage_read(masks_)
        .storage_read_write(stage.sums)
        .storage_write(stage.output)
        .push(constants);
    stage.dispatch(pass, shared::command_groups);
    return {};
}

} // namespace sunfleck::gi

#include "gi_module/splatting/splat_kernel.h"

#include "gi_module/shadows/octahedral_map.h"

#include <algorithm>
#include <cstring>

namespace sunfleck::gi {
namespace {

bool is_glossy(const shared::PixelLightRow& light) {
    return light.lobe.w > 1.0f;
}

// Lights from `first` on that are all diffuse, or all have lobes.
std::span<const shared::PixelLightRow> batch_at(std::span<const shared::PixelLightRow> lights, std::size_t first) {
    std::size_t end = first + 1;
    while (end < lights.size() && end - first < shared::splats_per_batch &&
           is_glossy(lights[end]) == is_glossy(lights[first]))
        ++end;
    return lights.subspan(first, end - first);
}

} // namespace

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

Status SplatKernel::set_maps(gpu::FrameGraph& graph, std::span<const std::uint16_t> texels, std::uint32_t side,
                             bool filtered, gpu::FrameResources& resources) {
    map_side_ = texels.empty() ? 0 : side;
    filtered_ = filtered;
    maps_.forget_pieces();
    // Some drivers need every binding of a set to be alive, used or not.
    const std::uint64_t bytes = std::max<std::uint64_t>(texels.size_bytes(), 16);
    SUNFLECK_TRY(maps_.reserve(device_, resources, "shadow maps of pixel lights", bytes, VK_FORMAT_R16_UNORM));
    if (texels.empty())
        return {};
    SUNFLECK_TRY(maps_.write(resources, 0, std::as_bytes(texels)));
    maps_.add_pass(graph);
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
    for (std::size_t first = 0; first < lights.size();) {
        const std::span<const shared::PixelLightRow> batch = batch_at(lights, first);
        first += batch.size();
        SUNFLECK_ASSIGN(const gpu::UploadSlice rows,
                        resources.allocate(sizeof(shared::PixelLightRow) * shared::splats_per_batch));
        std::memcpy(rows.data, batch.data(), batch.size_bytes());
        const shared::SplattingConstants constants{stage.constants.width,
                                                   stage.constants.height,
                                                   stage.constants.group_count,
                                                   std::uint32_t(batch.size()),
                                                   map_side_,
                                                   least_};
        if (lists_)
            SUNFLECK_TRY(add_lists(stage, rows, constants));
        SUNFLECK_TRY(
            add_light(stage, rows, constants, is_glossy(batch.front()), writes_picture && first == lights.size()));
    }
    return {};
}

Status SplatKernel::add_lists(const PixelStage& stage, const gpu::UploadSlice& rows,
                              const shared::SplattingConstants& constants) {
    gpu::ComputeDescription description;
    description.shader = "gi_module/splatting/splat_lists.comp";
    description.specialization = {stage.repair, show_};
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
                              const shared::SplattingConstants& constants, bool glossy, bool to_image) {
    const std::uint32_t lanes = device_.traits().software ? 8 : 64;
    gpu::ComputeDescription description;
    description.shader = "gi_module/splatting/splat_light.comp";
    description.specialization = {shared::pixel_group_size / lanes,
                                  lanes,
                                  to_image,
                                  map_side_ > 0 ? shared::maps_texel_buffer : shared::maps_none,
                                  filtered_,
                                  glossy,
                                  show_,
                                  lists_};
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
        .texels(maps_.buffer())
        .push(constants);
    stage.dispatch(pass, shared::command_groups);
    return {};
}

} // namespace sunfleck::gi

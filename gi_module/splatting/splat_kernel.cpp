#include "gi_module/splatting/splat_kernel.h"

#include "gi_module/shadows/octahedral_map.h"

#include <algorithm>
#include <cstring>

namespace sunfleck::gi {
namespace {

bool is_glossy(const shared::PixelLightRow& light) {
    return light.lobe.w > 1.0f;
}

bool is_beam(const shared::PixelLightRow& light) {
    return light.beam0.w > 0.0f;
}

bool has_diffuse(std::span<const shared::PixelLightRow> lights) {
    return !std::ranges::all_of(lights, is_glossy);
}

// Lights from `first` on that are all diffuse, or all have lobes.
std::span<const shared::PixelLightRow> batch_at(std::span<const shared::PixelLightRow> lights, std::size_t first) {
    std::size_t end = first + 1;
    while (end < lights.size() && end - first < shared::splats_per_batch &&
           is_glossy(lights[end]) == is_glossy(lights[first]))
        ++end;
    return lights.subspan(first, end - first);
}

// Of a tile's radii, how far from it a light is smooth over it. Interpolated irradiance is then within a few
// hundredths; and where there are shadows, a tile is seen from the light no wider than the texels that blend in its
// map.
float nearest_radii(std::uint32_t map_side) {
    return std::max(2.0f, 0.5f * float(map_side));
}

} // namespace

Result<std::unique_ptr<SplatKernel>> SplatKernel::create(gpu::Device& device, gpu::PipelineStore& pipelines) {
    std::unique_ptr<SplatKernel> kernel(new SplatKernel(device, pipelines));
    const VkSamplerCreateInfo sampler{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
    SUNFLECK_VK(device.vk.vkCreateSampler(device.handle(), &sampler, nullptr, &kernel->sampler_), "creating a sampler");
    kernel->levels_ = std::make_unique<SplatLevels>(device, pipelines, kernel->sampler_);
    return kernel;
}

SplatKernel::~SplatKernel() {
    device_.vk.vkDestroySampler(device_.handle(), sampler_, nullptr);
}

Status SplatKernel::make_masks(const PixelStage& stage, gpu::FrameResources& resources) {
    const std::uint64_t groups = std::max(stage.constants.group_capacity, stage.constants.group_count);
    SUNFLECK_TRY(make_room(device_, masks_, "pixel lights of groups", groups * mask_bytes, resources));
    return blocks_on_ ? make_room(device_, blocks_, "pixel lights of blocks", groups * block_bytes, resources)
                      : Status();
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

shared::SplattingConstants SplatKernel::constants_of(const PixelStage& stage) const {
    const shared::LowResolutionConstants& low = stage.constants;
    return {low.width,
            low.height,
            low.group_count,
            0,
            map_side_,
            least_,
            low.scale,
            low.group_columns,
            low.group_columns > 0 ? low.group_count / low.group_columns : 0,
            0,
            1,
            nearest_radii(map_side_)};
}

Status SplatKernel::add_passes(const PixelStage& stage, std::span<const shared::PixelLightRow> lights,
                               gpu::FrameResources& resources) {
    if (stage.first)
        SUNFLECK_TRY(stage.low_resolution.list_pixels(stage));
    const bool writes_picture = stage.last && stage.resolves;
    if (lights.empty())
        return writes_picture ? stage.low_resolution.resolve(stage) : Status();
    SUNFLECK_TRY(make_masks(stage, resources));
    shared::SplattingConstants constants = constants_of(stage);
    const bool by_levels = levels_on_ && lists_ && !stage.repair && !shared::shows_places(show_);
    if (by_levels)
        SUNFLECK_TRY(levels_->add_tiles(stage, constants, resources));
    for (std::size_t first = 0; first < lights.size();) {
        const std::span<const shared::PixelLightRow> batch = batch_at(lights, first);
        first += batch.size();
        constants.light_count = std::uint32_t(batch.size());
        const bool glossy = is_glossy(batch.front()), nodes = by_levels && !glossy;
        const BatchKind kind{glossy,
                             std::ranges::any_of(batch, is_beam),
                             nodes,
                             glossy && lists_ && blocks_on_,
                             nodes && !has_diffuse(lights.subspan(first)),
                             writes_picture && first == lights.size()};
        SUNFLECK_TRY(add_batch(stage, batch, constants, kind, resources));
        constants.first = constants.first != 0 && !nodes;
    }
    return {};
}

Status SplatKernel::add_batch(const PixelStage& stage, std::span<const shared::PixelLightRow> batch,
                              const shared::SplattingConstants& constants, const BatchKind& kind,
                              gpu::FrameResources& resources) {
    SUNFLECK_ASSIGN(const gpu::UploadSlice rows,
                    resources.allocate(sizeof(shared::PixelLightRow) * shared::splats_per_batch));
    std::memcpy(rows.data, batch.data(), batch.size_bytes());
    if (kind.by_levels)
        SUNFLECK_TRY(
            levels_->add_batch(stage, constants, {rows, masks_, maps_.buffer(), map_side_ > 0, filtered_, show_}));
    else if (lists_)
        SUNFLECK_TRY(add_lists(stage, rows, constants, false));
    if (kind.by_blocks)
        SUNFLECK_TRY(add_lists(stage, rows, constants, true));
    return add_light(stage, rows, constants, kind);
}

Status SplatKernel::add_lists(const PixelStage& stage, const gpu::UploadSlice& rows,
                              const shared::SplattingConstants& constants, bool of_blocks) {
    gpu::ComputeDescription description;
    description.shader = "gi_module/splatting/splat_lists.comp";
    description.specialization = {stage.repair, show_, of_blocks};
    SUNFLECK_ASSIGN(const gpu::Pipeline* kernel, pipelines_.compute(description));
    gpu::ComputePass pass(stage.graph, stage.repair ? "repair splat lists" : "splat lists", *kernel);
    pass.uniform(stage.camera)
        .sampled(stage.g_buffer.depth, sampler_)
        .sampled(stage.g_buffer.normals, sampler_)
        .uniform(rows)
        .storage_read(stage.pixels)
        .storage_read(stage.commands);
    if (of_blocks)
        pass.storage_read_write(masks_).storage_write(blocks_);
    else
        pass.storage_read_write(masks_).unused(masks_);
    pass.push(constants);
    stage.dispatch(pass, of_blocks ? shared::command_groups : shared::command_packed);
    return {};
}

Status SplatKernel::add_light(const PixelStage& stage, const gpu::UploadSlice& rows,
                              const shared::SplattingConstants& constants, const BatchKind& kind) {
    const std::uint32_t lanes = device_.traits().software ? 8 : 64;
    gpu::ComputeDescription description;
    description.shader = "gi_module/splatting/splat_light.comp";
    description.specialization = {shared::pixel_group_size / lanes,
                                  lanes,
                                  kind.to_image,
                                  map_side_ > 0 ? shared::maps_texel_buffer : shared::maps_none,
                                  filtered_,
                                  kind.beams    ? 2u
                                  : kind.glossy ? 1u
                                                : 0u,
                                  show_,
                                  lists_,
                                  kind.takes_nodes,
                                  kind.by_blocks};
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
        .texels(maps_.buffer());
    if (kind.takes_nodes)
        pass.storage_read(levels_->points()).storage_read(levels_->patches()).storage_read(levels_->places());
    else
        pass.unused(masks_).unused(masks_).unused(masks_);
    if (kind.by_blocks)
        pass.storage_read(blocks_);
    else
        pass.unused(masks_);
    pass.push(constants);
    stage.dispatch(pass, shared::command_groups);
    return {};
}

} // namespace sunfleck::gi

#include "gi_module/splatting/splat_levels.h"

#include "engine/core/divide_up.h"
#include "gi_module/shadows/octahedral_map.h"

namespace sunfleck::gi {
namespace {

std::uint32_t tiles_of(const shared::SplattingConstants& constants, std::uint32_t level) {
    return shared::tiles_of_level(constants.columns, constants.rows, level);
}

// Of passes that handle one level after the other.
shared::SplattingConstants at_level(shared::SplattingConstants constants, std::uint32_t level) {
    constants.level = level;
    return constants;
}

} // namespace

Status make_room(gpu::Device& device, gpu::Buffer& buffer, const char* name, std::uint64_t bytes,
                 gpu::FrameResources& resources) {
    if (buffer && buffer.size() >= bytes)
        return {};
    if (buffer)
        resources.retire(std::move(buffer));
    SUNFLECK_ASSIGN(buffer, gpu::Buffer::create(device, {name, bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                                                         gpu::MemoryUse::device, VK_FORMAT_UNDEFINED}));
    return {};
}

Status SplatLevels::make_buffers(const shared::SplattingConstants& constants, gpu::FrameResources& resources) {
    const std::uint64_t tiles = shared::first_tile(constants.columns, constants.rows, shared::tile_levels);
    const std::uint64_t mask_bytes = tiles * shared::splat_mask_words * sizeof(std::uint32_t);
    SUNFLECK_TRY(make_room(device_, tiles_, "tiles of splatted light", tiles * sizeof(shared::SplatTile), resources));
    SUNFLECK_TRY(make_room(device_, done_, "pixel lights that tiles are done with", mask_bytes, resources));
    SUNFLECK_TRY(make_room(device_, smooth_, "pixel lights that are smooth over tiles", mask_bytes, resources));
    SUNFLECK_TRY(
        make_room(device_, nodes_, "light at nodes of tiles", tiles * shared::tile_nodes * sizeof(vec4), resources));
    const std::uint64_t groups = tiles_of(constants, 0), entries = groups * shared::pixel_group_size;
    SUNFLECK_TRY(
        make_room(device_, patches_, "pieces of surface of groups", groups * sizeof(shared::GroupPatches), resources));
    SUNFLECK_TRY(
        make_room(device_, places_, "pieces of surface of pixels", entries * sizeof(std::uint32_t), resources));
    return make_room(device_, points_, "light at nodes of groups", entries * sizeof(vec4), resources);
}

Status SplatLevels::add_tiles(const PixelStage& stage, const shared::SplattingConstants& constants,
                              gpu::FrameResources& resources) {
    SUNFLECK_TRY(make_buffers(constants, resources));
    gpu::ComputeDescription description;
    description.shader = "gi_module/splatting/splat_patches.comp";
    SUNFLECK_ASSIGN(const gpu::Pipeline* patches, pipelines_.compute(description));
    description.shader = "gi_module/splatting/splat_tiles.comp";
    SUNFLECK_ASSIGN(const gpu::Pipeline* kernel, pipelines_.compute(description));
    gpu::ComputePass(stage.graph, "splat tiles", *patches)
        .uniform(stage.camera)
        .sampled(stage.g_buffer.depth, sampler_)
        .sampled(stage.g_buffer.normals, sampler_)
        .storage_read(stage.pixels)
        .storage_write(tiles_)
        .storage_write(patches_)
        .storage_read_write(places_)
        .push(constants)
        .dispatch(divide_up(tiles_of(constants, 0), 8));
    for (std::uint32_t level = 1; level < shared::tile_levels; ++level)
        gpu::ComputePass(stage.graph, "splat tiles", *kernel)
            .uniform(stage.camera)
            .storage_read_write(tiles_)
            .push(at_level(constants, level))
            .dispatch(divide_up(tiles_of(constants, level), 8));
    return {};
}

Status SplatLevels::add_batch(const PixelStage& stage, const shared::SplattingConstants& constants,
                              const Batch& batch) {
    SUNFLECK_TRY(add_masks(stage, constants, batch));
    return add_nodes(stage, constants, batch);
}

Status SplatLevels::add_masks(const PixelStage& stage, const shared::SplattingConstants& constants,
                              const Batch& batch) {
    gpu::ComputeDescription description;
    description.shader = "gi_module/splatting/splat_levels.comp";
    SUNFLECK_ASSIGN(const gpu::Pipeline* kernel, pipelines_.compute(description));
    for (std::uint32_t level = shared::tile_levels; level-- > 0;)
        gpu::ComputePass(stage.graph, "splat levels", *kernel)
            .uniform(batch.rows)
            .storage_read(tiles_)
            .storage_read_write(done_)
            .storage_write(smooth_)
            .storage_write(batch.masks)
            .storage_read(patches_)
            .push(at_level(constants, level))
            .dispatch(divide_up(tiles_of(constants, level), 8));
    return {};
}

Status SplatLevels::add_nodes(const PixelStage& stage, const shared::SplattingConstants& constants,
                              const Batch& batch) {
    const std::uint32_t lanes = device_.traits().software ? 8 : 64;
    gpu::ComputeDescription description;
    description.shader = "gi_module/splatting/splat_nodes.comp";
    for (std::uint32_t level = shared::tile_levels; level-- > 0;) {
        description.specialization = {lanes, batch.has_maps ? shared::maps_texel_buffer : shared::maps_none,
                                      batch.filtered, batch.show, level == 0};
        SUNFLECK_ASSIGN(const gpu::Pipeline* kernel, pipelines_.compute(description));
        gpu::ComputePass(stage.graph, "splat nodes", *kernel)
            .uniform(stage.camera)
            .uniform(batch.rows)
            .storage_read(tiles_)
            .storage_read(smooth_)
            .storage_read_write(nodes_)
            .texels(batch.maps)
            .sampled(stage.g_buffer.depth, sampler_)
            .sampled(stage.g_buffer.normals, sampler_)
            .storage_read(stage.pixels)
            .storage_read(patches_)
            .storage_read(places_)
            .storage_read_write(points_)
            .push(at_level(constants, level))
            .dispatch(divide_up(tiles_of(constants, level) * shared::tile_nodes, lanes));
    }
    return {};
}

std::uint64_t SplatLevels::memory_bytes() const {
    return tiles_.size() + patches_.size() + places_.size() + done_.size() + smooth_.size() + nodes_.size() +
           points_.size();
}

} // namespace sunfleck::gi

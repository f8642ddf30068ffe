// Multiresolution: evaluates pixel lights at few places where they are smooth over a flat piece of the picture, in
// place of cutting them where they are faint. Runs splat_patches.comp, splat_tiles.comp, splat_levels.comp and
// splat_nodes.comp; what is left to
// single pixels is a group's mask, as splat_lists.comp makes it.
#pragma once

#include "gi_module/low_resolution/low_resolution.h"
#include "gi_module/splatting/splatting_shared.h"

namespace sunfleck::gi {

// Makes a storage buffer of at least so many bytes, unless it is one.
Status make_room(gpu::Device& device, gpu::Buffer& buffer, const char* name, std::uint64_t bytes,
                 gpu::FrameResources& resources);

class SplatLevels {
public:
    SplatLevels(gpu::Device& device, gpu::PipelineStore& pipelines, VkSampler sampler)
        : device_(device), pipelines_(pipelines), sampler_(sampler) {}

    // Of a stage that lights the low-resolution picture, before its first batch: what the tiles show.
    Status add_tiles(const PixelStage& stage, const shared::SplattingConstants& constants,
                     gpu::FrameResources& resources);
    // What a batch is drawn with: shadow maps of the lights and the debug view, as splat_light.comp has them.
    struct Batch {
        const gpu::UploadSlice& rows; // PixelLightRow
        const gpu::Buffer& masks;     // of pixel groups: written
        const gpu::Buffer& maps;      // texels
        bool has_maps = false, filtered = false;
        std::uint32_t show = shared::show_no_splats;
    };
    // Of diffuse lights. Afterwards, points() has what all since add_tiles give the groups' nodes and points, 64 of
    // each group.
    Status add_batch(const PixelStage& stage, const shared::SplattingConstants& constants, const Batch& batch);
    const gpu::Buffer& points() const { return points_; }
    const gpu::Buffer& patches() const { return patches_; }
    const gpu::Buffer& places() const { return places_; }
    std::uint64_t memory_bytes() const;

private:
    Status make_buffers(const shared::SplattingConstants& constants, gpu::FrameResources& resources);
    Status add_masks(const PixelStage& stage, const shared::SplattingConstants& constants, const Batch& batch);
    Status add_nodes(const PixelStage& stage, const shared::SplattingConstants& constants, const Batch& batch);

    gpu::Device& device_;
    gpu::PipelineStore& pipelines_;
    VkSampler sampler_;
    gpu::Buffer tiles_, patches_, places_, done_, smooth_, nodes_, points_;
};

} // namespace sunfleck::gi

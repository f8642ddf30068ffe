// Runs splat_lists.comp (or splat_levels.h) and splat_light.comp: adds the light of pixel lights to the sums of a
// stage's pixels.
#pragma once

#include "engine/gpu/uploaded_buffer.h"
#include "gi_module/low_resolution/low_resolution.h"
#include "gi_module/splatting/splat_levels.h"
#include "gi_module/splatting/splatting_shared.h"

#include <memory>
#include <span>

namespace sunfleck::gi {

class SplatKernel {
public:
    static Result<std::unique_ptr<SplatKernel>> create(gpu::Device& device, gpu::PipelineStore& pipelines);
    ~SplatKernel();

    // Shadow maps of the frame's lights, by slot, `side` texels a side; none: nothing blocks their light. Once a frame,
    // before add_passes.
    Status set_maps(gpu::FrameGraph& graph, std::span<const std::uint16_t> texels, std::uint32_t side, bool filtered,
                    gpu::FrameResources& resources);
    // Whether groups of pixels have lists of lights, from the next add_passes on.
    void set_lists(bool lists) { lists_ = lists; }
    // Whether lights are evaluated at nodes of tiles where they are smooth (splat_levels.h), from the next add_passes
    // on.
    void set_levels(bool levels) { levels_on_ = levels; }
    // Irradiance, W/m2, below which light may be cut, from the next add_passes on.
    void set_least(float least) { least_ = least; }
    // Whether lobes have lists of blocks of pixels, too, from the next add_passes on.
    void set_blocks(bool blocks) { blocks_on_ = blocks; }
    // show_... of splatting_shared.h, from the next add_passes on.
    void set_show(std::uint32_t show) { show_ = show; }
    // For each stage of a frame. The rows last as long as the call.
    Status add_passes(const PixelStage& stage, std::span<const shared::PixelLightRow> lights,
                      gpu::FrameResources& resources);
    // Its memory for a group of pixels.
    std::uint64_t bytes_per_group() const { return mask_bytes + (blocks_on_ ? block_bytes : 0); }
    std::uint64_t memory_bytes() const {
        return masks_.size() + blocks_.size() + maps_.buffer().size() + levels_->memory_bytes();
    }

private:
    static constexpr std::uint64_t mask_bytes = shared::splat_mask_words * 4; // of a group
    static constexpr std::uint64_t block_bytes = shared::splat_blocks * shared::splat_block_words * 4;

    SplatKernel(gpu::Device& device, gpu::PipelineStore& pipelines) : device_(device), pipelines_(pipelines) {}
    Status make_masks(const PixelStage& stage, gpu::FrameResources& resources);
    Status add_lists(const PixelStage& stage, const gpu::UploadSlice& rows, const shared::SplattingConstants& constants,
                     bool of_blocks);
    struct BatchKind {
        bool glossy = false, beams = false; // lobes, beams among them
        bool by_levels = false, by_blocks = false;
        bool takes_nodes = false; // the last by levels, which adds what all gave the nodes
        bool to_image = false;    // the last of all, which writes the picture
    };
    shared::SplattingConstants constants_of(const PixelStage& stage) const;
    Status add_batch(const PixelStage& stage, std::span<const shared::PixelLightRow> batch,
                     const shared::SplattingConstants& constants, const BatchKind& kind,
                     gpu::FrameResources& resources);
    Status add_light(const PixelStage& stage, const gpu::UploadSlice& rows, const shared::SplattingConstants& constants,
                     const BatchKind& kind);

    gpu::Device& device_;
    gpu::PipelineStore& pipelines_;
    VkSampler sampler_ = VK_NULL_HANDLE;
    gpu::Buffer masks_, blocks_;
    gpu::UploadedBuffer maps_;
    std::unique_ptr<SplatLevels> levels_;
    std::uint32_t map_side_ = 0; // 0: there are none
    bool filtered_ = false, lists_ = true, levels_on_ = false, blocks_on_ = false;
    float least_ = 0.0f;
    std::uint32_t show_ = shared::show_no_splats;
};

} // namespace sunfleck::gi

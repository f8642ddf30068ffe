// Runs punctual_lists.comp, punctual_blocks.comp and punctual_light.glsl.
#pragma once

#include "engine/gpu/frame_graph.h"
#include "gi_module/adaptive_shadows/adaptive_shadows_shared.h"
#include "gi_module/transport/g_buffer.h"

#include <array>
#include <memory>
#include <span>
#include <vector>

namespace sunfleck::gi {

struct PunctualFrame {
    gpu::FrameGraph& graph;
    const GBufferInput& g_buffer;
    const gpu::UploadSlice& camera;
    const gpu::Buffer* maps = nullptr; // texels, slot after slot; null: nothing casts shadows
    gpu::ResourceId picture;
    bool adds = false; // to what the picture holds
};

// At most lights_per_pass.
struct PunctualBatch {
    std::vector<shared::TileLight> lights;
    std::array<std::uint32_t, shared::map_kinds> kind_lights{}; // bits of those with a kind of map
};

class PunctualKernel {
public:
    static Result<std::unique_ptr<PunctualKernel>> create(gpu::Device& device, gpu::PipelineStore& pipelines);
    ~PunctualKernel();

    // Lights every pixel of the picture: of a batch, only blocks that one of its lights may reach. `table`: of all
    // lights, TileLight::table_first on.
    Status add_passes(const PunctualFrame& frame, std::span<const PunctualBatch> batches,
                      std::span<const std::uint32_t> table, gpu::FrameResources& resources);

private:
    PunctualKernel(gpu::Device& device, gpu::PipelineStore& pipelines) : device_(device), pipelines_(pipelines) {}
    Status grow_buffers(std::size_t blocks, gpu::FrameResources& resources);
    Status add_lists(const PunctualFrame& frame, const PunctualBatch& batch, const gpu::UploadSlice& lights,
                     bool clears);
    Status add_light(const PunctualFrame& frame, const PunctualBatch& batch, std::uint32_t map_kind,
                     const gpu::UploadSlice& lights, const gpu::UploadSlice& table);
    shared::PunctualConstants constants_of(const PunctualFrame& frame, const PunctualBatch& batch) const;
    // Of an invocation: a CPU device reads a light's row once for each; a GPU wants many small ones instead.
    std::uint32_t pixels() const { return device_.traits().software ? 8 : 1; }

    gpu::Device& device_;
    gpu::PipelineStore& pipelines_;
    VkSampler sampler_ = VK_NULL_HANDLE;
    gpu::Buffer masks_, blocks_; // lights of each block; by kind of map, the blocks that have any
    gpu::Buffer commands_, no_texels_;
};

} // namespace sunfleck::gi

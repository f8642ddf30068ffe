// Runs punctual_light.glsl.
#pragma once

#include "engine/gpu/frame_graph.h"
#include "gi_module/adaptive_shadows/adaptive_shadows_shared.h"
#include "gi_module/transport/g_buffer.h"

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

// Lights whose maps are of one kind.
struct PunctualBatch {
    std::uint32_t map_kind = 0;
    std::vector<shared::TileLight> lights;
};

class PunctualKernel {
public:
    static Result<std::unique_ptr<PunctualKernel>> create(gpu::Device& device, gpu::PipelineStore& pipelines);
    ~PunctualKernel();

    // Writes every pixel of the picture. `table`: of all lights, TileLight::table_first on.
    Status add_passes(const PunctualFrame& frame, std::span<const PunctualBatch> batches,
                      std::span<const std::uint32_t> table, gpu::FrameResources& resources);

private:
    PunctualKernel(gpu::Device& device, gpu::PipelineStore& pipelines) : device_(device), pipelines_(pipelines) {}
    Status grow_sums(const PunctualFrame& frame, bool needed, gpu::FrameResources& resources);

    gpu::Device& device_;
    gpu::PipelineStore& pipelines_;
    VkSampler sampler_ = VK_NULL_HANDLE;
    gpu::Buffer sums_, no_texels_;
};

} // namespace sunfleck::gi

// Adds the light of several techniques into one picture. The first technique of a frame writes the picture itself where
// it lights every receiver; each further one writes a layer, which is added here.
#pragma once

#include "engine/gpu/frame_graph.h"
#include "engine/scene/gpu_scene.h"
#include "gi_module/light_sum/light_sum_shared.h"
#include "gi_module/light_sum/pixel_area.h"
#include "gi_module/transport/g_buffer.h"

namespace sunfleck::gi {

class LightSum {
public:
    static Result<std::unique_ptr<LightSum>> create(gpu::Device& device, gpu::PipelineStore& pipelines);
    ~LightSum();

    // No light anywhere; alpha 1 where the G-buffer has a surface. `picture`: RGBA16F or RGBA32F, storage.
    Status clear(gpu::FrameGraph& graph, const GBufferInput& g_buffer, gpu::ResourceId picture,
                 gpu::FrameResources& resources);

    // Zero everywhere, by storage writes. `image`: any storage format of floats.
    void set_to_zero(gpu::FrameGraph& graph, gpu::ResourceId image);

    struct Layer {
        gpu::ResourceId image; // W/m2; alpha 0 where it has nothing
        PixelArea area;        // outside it has nothing, whatever it holds
        bool replaces = false; // where it has alpha, the receiver is lit by nobody else
        std::uint32_t receivers = shared::receiver_fixed | shared::receiver_mover; // of others it takes nothing
    };
    Status add(gpu::FrameGraph& graph, const scene::GpuScene& scene, const GBufferInput& g_buffer, const Layer& layer,
               gpu::ResourceId picture, gpu::FrameResources& resources);

private:
    explicit LightSum(gpu::Device& device) : device_(device) {}
    Status add_pass(gpu::FrameGraph& graph, const GBufferInput& g_buffer, gpu::ResourceId layer,
                    gpu::ResourceId picture, const gpu::UploadSlice& receivers,
                    const shared::LightSumConstants& constants);

    gpu::Device& device_;
    VkSampler sampler_ = VK_NULL_HANDLE;
    const gpu::Pipeline* halves_ = nullptr; // for pictures of 16-bit floats
    const gpu::Pipeline* floats_ = nullptr;
    const gpu::Pipeline* zeros_ = nullptr;
};

} // namespace sunfleck::gi

// The geometry pass. Its images are what the GI module reads (see gi_module/transport/g_buffer.h for their contract).
#pragma once

#include "engine/gpu/frame_graph.h"
#include "engine/scene/camera_view.h"
#include "engine/scene/gpu_scene.h"

namespace sunfleck::render {

inline constexpr VkFormat depth_format = VK_FORMAT_D32_SFLOAT;    // reverse Z, 0 where nothing is
inline constexpr VkFormat normals_format = VK_FORMAT_R32G32_UINT; // shading, geometric; octahedral 2 x 16 bits
inline constexpr VkFormat surface_format = VK_FORMAT_R32_UINT;    // instance row + 1, 0 where nothing is
inline constexpr VkFormat albedo_format = VK_FORMAT_R8G8B8A8_SRGB;
inline constexpr VkFormat motion_format = VK_FORMAT_R16G16_SFLOAT;

struct GBuffer {
    gpu::ResourceId depth, normals, surface, albedo, motion;
    std::uint32_t width = 0, height = 0;
};

class GBufferPass {
public:
    static Result<GBufferPass> create(gpu::PipelineStore& pipelines);

    // Adds the pass that draws `scene` as seen by the camera in `camera` (a CameraRow). Without `motion` that image is
    // left out (its id is not valid).
    GBuffer add(gpu::FrameGraph& graph, const scene::GpuScene& scene, const gpu::UploadSlice& camera,
                std::uint32_t width, std::uint32_t height, bool motion = true) const;

private:
    Status record(gpu::PassContext& context, const scene::GpuScene& scene, const gpu::UploadSlice& camera,
                  const GBuffer& target) const;
    static constexpr std::uint32_t pattern_kinds = 5;
    // By kind of pattern.
    const gpu::Pipeline* with_motion_[pattern_kinds] = {};
    const gpu::Pipeline* without_motion_[pattern_kinds] = {};
};

} // namespace sunfleck::render

// The geometry pass. Its images are what the GI module reads (see gi_module/transport/g_buffer.h for their contract).
#pragma once

#include "engine/gpu/frame_graph.h"
#include "engine/scene/camera_view.h"
#include "engine/scene/gpu_scene.h"

namespace sunfleck::render {

inline constexpr VkFormat depth_format = VK_FORMAT_D32_SFLOAT;      // reverse Z, 0 where nothing is
inline constexpr VkFormat normals_format = VK_FORMAT_R32G32_UINT;   // shading, geometric; octahedral 2 x 16 bits
inline constexpr VkFormat surface_format = VK_FORMAT_R32_UINT;      // instance row + 1, 0 where nothing is
inline constexpr VkFormat albedo_format = VK_FORMAT_R8G8B8A8_UNORM; // see pack_albedo()
inline constexpr VkFormat motion_format = VK_FORMAT_R16G16_SFLOAT;
inline constexpr VkFormat emission_format = VK_FORMAT_R16G16B16A16_SFLOAT;
inline constexpr VkFormat gloss_format = VK_FORMAT_R8G8_UNORM; // metallic, roughness

struct GBuffer {
    gpu::ResourceId depth, normals, surface, albedo, motion;
    gpu::ResourceId emission; // radiance W/(sr m2), RGBA16F; only where some emission has a texture
    gpu::ResourceId gloss;    // only where some metallic or roughness has a texture
    std::uint32_t width = 0, height = 0;
};

class GBufferPass {
public:
    static Result<GBufferPass> create(gpu::PipelineStore& pipelines);

    // Adds the pass that draws `scene` as seen by the camera in `camera` (a CameraRow). Without `motion` that image is
    // left out (its id is not valid), unless emission or gloss need an image, too.
    GBuffer add(gpu::FrameGraph& graph, const scene::GpuScene& scene, const gpu::UploadSlice& camera,
                std::uint32_t width, std::uint32_t height, bool motion = true) const;

private:
    Status record(gpu::PassContext& context, const scene::GpuScene& scene, const gpu::UploadSlice& camera,
                  const GBuffer& target) const;
    // What is written besides normals, surface and albedo.
    enum Extra : std::uint32_t { nothing, motion, emission_and_gloss, extras };
    Status draw(gpu::PassContext& context, const scene::GpuScene& scene, const gpu::UploadSlice& camera,
                Extra extra) const;
    const gpu::Pipeline* pipelines_[extras][scene::surface_kinds] = {};
};

} // namespace sunfleck::render

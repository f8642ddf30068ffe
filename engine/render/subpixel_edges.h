// Smooths the edges of a display picture's surfaces, and enlarges it, by where they are within its pixels. Depth and
// surface are drawn once more at the target's size, with four samples a pixel; each sample takes its colour from those
// of the four pixels about it that show its surface and the plane that it lies on (after M. Chajdas, M. McGuire, D.
// Luebke, "Subpixel reconstruction antialiasing for deferred shading", I3D 2011, whose samples have depths and normals:
// planes tell apart what meets in a crease without). Elsewhere the picture is enlarged by the filter of upscale.h. Each
// frame by itself: nothing is left of the frames before.
//
// What is no edge of a surface (shadows, textures) is as smooth as the picture; what no pixel of the picture shows, the
// target does not show.
#pragma once

#include "engine/render/g_buffer.h"

#include <memory>
#include <span>
#include <vector>

namespace sunfleck::render {

class SubpixelEdges {
public:
    static Result<std::unique_ptr<SubpixelEdges>> create(gpu::Device& device, gpu::PipelineStore& pipelines);
    ~SubpixelEdges();

    struct Input {
        gpu::ResourceId picture; // storage image of 8 bits a channel, with display values
        GBuffer g_buffer;        // of the same size
        gpu::UploadSlice camera; // of the G-buffer, which sees each pixel through its middle
    };
    // `target` is a storage image of the picture's size or any other, which is written whole.
    Status add(gpu::FrameGraph& graph, const scene::GpuScene& scene, const Input& input, gpu::ResourceId target,
               gpu::FrameResources& resources);

private:
    struct Samples {
        gpu::ResourceId depth, surface;
        std::uint32_t width = 0, height = 0;
    };
    explicit SubpixelEdges(gpu::Device& device) : device_(device) {}
    Status make_pipelines(gpu::PipelineStore& pipelines);
    Status make_buffers(const scene::GpuScene& scene, std::uint32_t places, gpu::FrameResources& resources);
    void add_clearing(gpu::FrameGraph& graph) const;
    Samples add_samples(gpu::FrameGraph& graph, const scene::GpuScene& scene, const Input& input,
                        const gpu::ImageDescription& target) const;
    Status record(gpu::PassContext& context, const scene::GpuScene& scene, const gpu::UploadSlice& camera,
                  const Samples& target) const;
    Status draw(gpu::PassContext& context, const scene::GpuScene& scene, const gpu::UploadSlice& camera) const;
    Status draw_items(gpu::PassContext& context, const scene::GpuScene& scene, const gpu::UploadSlice& camera,
                      std::span<const scene::DrawItem* const> items, bool emits) const;
    std::vector<gpu::Binding> bindings_of(const gpu::Pipeline& pipeline, const scene::DrawItem& item,
                                          const scene::GpuScene& scene, const gpu::UploadSlice& camera) const;

    gpu::Device& device_;
    const gpu::Pipeline* shown_ = nullptr;
    const gpu::Pipeline* samples_[2][2] = {}; // of surfaces with holes; that emit
    struct Kernels {
        const gpu::Pipeline* enlargement = nullptr; // which lists edges
        const gpu::Pipeline* edges = nullptr;
    };
    Kernels doubling_; // to twice the size
    Kernels any_;
    VkSampler sampler_ = VK_NULL_HANDLE;
    gpu::Buffer rows_;   // by row of the scene: 1 if a pixel of the picture shows it
    gpu::Buffer places_; // edge_places.glsl
};

} // namespace sunfleck::render

// Smooths the edges of a display picture's surfaces, and enlarges it, by where they are within its pixels. Depth and
// surface are drawn once more at the target's size, with four samples a pixel; each sample takes its colour from those
// of the four pixels about it that show its surface and the plane that it lies on (after M. Chajdas, M. McGuire, D.
// Luebke, "Subpixel reconstruction antialiasing for deferred shading", I3D 2011, whose samples have depths and normals:
// planes tell apart what meets in a crease without). Elsewhere the picture is enlarged bilinearly. Each frame by
// itself: nothing is left of the frames before.
//
// Textures and patterns are drawn at the target's size as well: a sample shows its own albedo in the light of those
// pixels. (Not those of what emits, is blended or unlit.) Shadows are as smooth as the picture; what no pixel of the
// picture shows, the target does not show.
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
        gpu::ResourceId picture;              // storage image of 8 bits a channel, with display values
        GBuffer g_buffer;                     // of the same size
        gpu::UploadSlice camera;              // of the G-buffer, which sees each pixel through its middle
        gpu::ResourceId irradiance, specular; // that the picture was composed of, as CompositionInput has them
        float ev100 = 8.0f;                   // and its exposure
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
    struct Kernels;
    void add_listed(gpu::FrameGraph& graph, const Input& input, gpu::ResourceId target, const Samples& seen,
                    const Kernels& kernels) const;
    Samples add_samples(gpu::FrameGraph& graph, const scene::GpuScene& scene, const Input& input,
                        glm::ivec2 size) const;
    Status record(gpu::PassContext& context, const scene::GpuScene& scene, const gpu::UploadSlice& camera,
                  const Samples& target) const;
    Status draw(gpu::PassContext& context, const scene::GpuScene& scene, const gpu::UploadSlice& camera) const;
    Status draw_items(gpu::PassContext& context, const scene::GpuScene& scene, const gpu::UploadSlice& camera,
                      std::span<const scene::DrawItem* const> items, bool plain) const;
    const gpu::Pipeline& pipeline_of(const scene::DrawItem& item) const;
    std::vector<gpu::Binding> bindings_of(const gpu::Pipeline& pipeline, const scene::DrawItem& item,
                                          const scene::GpuScene& scene, const gpu::UploadSlice& camera) const;

    gpu::Device& device_;
    const gpu::Pipeline* shown_ = nullptr;
    // Of samples: those of surfaces with holes, or without, of which depth says all; that emit; whose albedo differs
    // from place to place, by surface kind.
    const gpu::Pipeline* plain_[2] = {};
    const gpu::Pipeline* emitting_[2] = {};
    const gpu::Pipeline* detailed_[scene::surface_kinds] = {};
    struct Kernels {
        const gpu::Pipeline* enlargement = nullptr;           // which lists the places of the others
        const gpu::Pipeline *edges[2] = {}, *details[2] = {}; // without gloss, with
    };
    Kernels doubling_; // to twice the size
    Kernels any_;
    VkSampler sampler_ = VK_NULL_HANDLE;
    gpu::Buffer rows_;   // by row of the scene: 1 if a pixel of the picture shows it
    gpu::Buffer places_; // subpixel_places.glsl
};

} // namespace sunfleck::render

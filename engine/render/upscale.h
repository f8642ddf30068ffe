// Enlarges a display picture: a bicubic (Catmull-Rom) filter that stays within the four nearest pixels' range, so that
// edges are sharp and have no halo.
#pragma once

#include "engine/gpu/frame_graph.h"
#include "engine/gpu/pipeline.h"

namespace sunfleck::render {

class UpscalePass {
public:
    static Result<UpscalePass> create(gpu::PipelineStore& pipelines);
    // Both are storage images with 8 bits a channel; `target` is written whole.
    void add(gpu::FrameGraph& graph, gpu::ResourceId source, gpu::ResourceId target) const;
    // To twice the size, which `target` must have, where `source` has edge codes as its alpha
    // (AntialiasingPass::add_codes): edges are drawn as the lines that they are, and are as sharp as `target` can show
    // them.
    void add_with_edges(gpu::FrameGraph& graph, gpu::ResourceId source, gpu::ResourceId target) const;

private:
    void add(gpu::FrameGraph& graph, const gpu::Pipeline& pipeline, bool doubling, gpu::ResourceId source,
             gpu::ResourceId target) const;
    const gpu::Pipeline* pipeline_ = nullptr;
    const gpu::Pipeline* doubling_ = nullptr;       // to twice the size
    const gpu::Pipeline* doubling_edges_ = nullptr; // the same with edge codes
};

} // namespace sunfleck::render

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

private:
    const gpu::Pipeline* pipeline_ = nullptr;
    const gpu::Pipeline* doubling_ = nullptr; // to twice the size
};

} // namespace sunfleck::render

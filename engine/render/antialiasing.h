// Smooths the edges of a display picture, whatever they come from: geometry, holes in textures, patterns, shadows. It
// follows each edge's stairs to where they end, and so knows how much of a pixel lies beyond the edge (A. Reshetov,
// "Morphological Antialiasing", 2009; along one line of stairs at a time, as in T. Lottes, "FXAA", 2009). A line
// thinner than a pixel, which shows in dashes, is drawn as faint as it covers pixels, in the gaps too, where it lies
// along an edge. Each frame by itself: nothing is left of the frames before.
#pragma once

#include "engine/gpu/frame_graph.h"
#include "engine/gpu/pipeline.h"

namespace sunfleck::render {

class AntialiasingPass {
public:
    static Result<AntialiasingPass> create(gpu::PipelineStore& pipelines);
    // Both are storage images of one size with 8 bits a channel; the alpha of `source` is its brightness
    // (CompositionInput::alpha_is_brightness); `target` is written whole.
    void add(gpu::FrameGraph& graph, gpu::ResourceId source, gpu::ResourceId target) const;

private:
    const gpu::Pipeline* kernel_ = nullptr;
};

} // namespace sunfleck::render

// Lines in the world, drawn over the finished picture and hidden by what stands before them.
#pragma once

#include "engine/render/g_buffer.h"

namespace sunfleck::render {

class DebugLines {
public:
    // `target_format`: of the picture that the lines go on.
    static Result<DebugLines> create(gpu::PipelineStore& pipelines, VkFormat target_format);

    // Lines of this frame; colour channels 0 to 1, display values.
    void line(vec3 from, vec3 to, vec3 colour);
    void box(const Bounds& bounds, vec3 colour);
    void clear() { vertices_.clear(); }

    // Adds nothing if there are no lines.
    void add(gpu::FrameGraph& graph, const GBuffer& g_buffer, const gpu::UploadSlice& camera,
             gpu::ResourceId target) const;

private:
    const gpu::Pipeline* pipeline_ = nullptr;
    std::vector<vec4> vertices_;
};

} // namespace sunfleck::render

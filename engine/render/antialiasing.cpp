#include "engine/render/antialiasing.h"

#include "engine/core/divide_up.h"
#include "engine/core/maths.h"
#include "engine/gpu/compute_pass.h"

namespace sunfleck::render {
namespace {

constexpr std::uint32_t antialiasing_rows = 4; // of an invocation: antialiasing_rows in the shader

} // namespace

Result<AntialiasingPass> AntialiasingPass::create(gpu::PipelineStore& pipelines) {
    AntialiasingPass pass;
    gpu::ComputeDescription description;
    description.shader = "engine/render/antialiasing.comp";
    SUNFLECK_ASSIGN(pass.kernel_, pipelines.compute(description));
    return pass;
}

void AntialiasingPass::add(gpu::FrameGraph& graph, gpu::ResourceId source, gpu::ResourceId target) const {
    const gpu::ImageDescription& size = graph.description(source);
    gpu::ComputePass(graph, "anti-aliasing", *kernel_)
        .storage_read(source)
        .storage_write(target)
        .push(glm::ivec2(int(size.width), int(size.height)))
        .dispatch(divide_up(size.width, 8), divide_up(size.height, 8 * antialiasing_rows));
}

} // namespace sunfleck::render

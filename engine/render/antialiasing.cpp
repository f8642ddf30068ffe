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
    description.specialization = {0};
    SUNFLECK_ASSIGN(pass.smoothing_, pipelines.compute(description));
    description.specialization = {1};
    SUNFLECK_ASSIGN(pass.coding_, pipelines.compute(description));
    return pass;
}

void AntialiasingPass::add(gpu::FrameGraph& graph, gpu::ResourceId source, gpu::ResourceId target) const {
    add(graph, *smoothing_, source, target);
}

void AntialiasingPass::add_codes(gpu::FrameGraph& graph, gpu::ResourceId source, gpu::ResourceId target) const {
    add(graph, *coding_, source, target);
}

void AntialiasingPass::add(gpu::FrameGraph& graph, const gpu::Pipeline& pipeline, gpu::ResourceId source,
                           gpu::ResourceId target) const {
    const gpu::ImageDescription& size = graph.description(source);
    gpu::ComputePass(graph, "anti-aliasing", pipeline)
        .storage_read(source)
        .storage_write(target)
        .push(glm::ivec2(int(size.width), int(size.height)))
        .dispatch(divide_up(size.width, 8), divide_up(size.height, 8 * antialiasing_rows));
}

} // namespace sunfleck::render

#include "engine/render/upscale.h"

#include "engine/core/divide_up.h"
#include "engine/gpu/compute_pass.h"
#include "engine/render/enlargement.h"

namespace sunfleck::render {

Result<UpscalePass> UpscalePass::create(gpu::PipelineStore& pipelines) {
    gpu::ComputeDescription description;
    description.shader = "engine/render/upscale.comp";
    UpscalePass pass;
    description.specialization = {0};
    SUNFLECK_ASSIGN(pass.pipeline_, pipelines.compute(description));
    description.specialization = {1};
    SUNFLECK_ASSIGN(pass.doubling_, pipelines.compute(description));
    return pass;
}

void UpscalePass::add(gpu::FrameGraph& graph, gpu::ResourceId source, gpu::ResourceId target) const {
    const EnlargementSizes sizes(graph.description(source), graph.description(target));
    const glm::uvec2 invocations = sizes.invocations();
    gpu::ComputePass(graph, "enlargement", sizes.doubles() ? *doubling_ : *pipeline_)
        .storage_read(source)
        .storage_write(target)
        .push(sizes)
        .dispatch(divide_up(invocations.x, 8), divide_up(invocations.y, 8));
}

} // namespace sunfleck::render

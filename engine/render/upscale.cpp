#include "engine/render/upscale.h"

#include "engine/core/divide_up.h"
#include "engine/core/maths.h"
#include "engine/gpu/compute_pass.h"

namespace sunfleck::render {
namespace {

struct Constants {
    glm::ivec2 source_size, target_size;
};

} // namespace

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
    const gpu::ImageDescription &from = graph.description(source), &to = graph.description(target);
    const bool doubling = to.width == 2 * from.width && to.height == 2 * from.height;
    // Doubling: an invocation for each gap between source pixels, those outside the border included.
    const std::uint32_t columns = doubling ? from.width + 1 : to.width, rows = doubling ? from.height + 1 : to.height;
    gpu::ComputePass(graph, "enlargement", doubling ? *doubling_ : *pipeline_)
        .storage_read(source)
        .storage_write(target)
        .push(Constants{{int(from.width), int(from.height)}, {int(to.width), int(to.height)}})
        .dispatch(divide_up(columns, 8), divide_up(rows, 8));
}

} // namespace sunfleck::render

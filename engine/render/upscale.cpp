#include "engine/render/upscale.h"

#include "engine/core/maths.h"

namespace sunfleck::render {
namespace {

struct Constants {
    glm::ivec2 source_size, target_size;
};

} // namespace

Result<UpscalePass> UpscalePass::create(gpu::PipelineStore& pipelines) {
    gpu::ComputeDescription description;
    description.shader = "engine/render/upscale.comp";
    description.bindings = {gpu::BindingKind::storage_image, gpu::BindingKind::storage_image};
    description.push_constant_bytes = sizeof(Constants);
    UpscalePass pass;
    description.specialization = {0};
    SUNFLECK_ASSIGN(pass.pipeline_, pipelines.compute(description));
    description.specialization = {1};
    SUNFLECK_ASSIGN(pass.doubling_, pipelines.compute(description));
    return pass;
}

void UpscalePass::add(gpu::FrameGraph& graph, gpu::ResourceId source, gpu::ResourceId target) const {
    graph.add_pass("enlargement")
        .read(source, gpu::Usage::storage_read)
        .write(target, gpu::Usage::storage_write)
        .execute([this, source, target](gpu::PassContext& context) -> Status {
            const gpu::ImageDescription& from = context.graph.description(source);
            const gpu::ImageDescription& to = context.graph.description(target);
            const gpu::Binding bindings[] = {gpu::Binding::storage_image(context.graph.view(source)),
                                             gpu::Binding::storage_image(context.graph.view(target))};
            const bool doubling = to.width == 2 * from.width && to.height == 2 * from.height;
            const gpu::Pipeline& pipeline = doubling ? *doubling_ : *pipeline_;
            SUNFLECK_TRY(context.resources.bind(context.commands, pipeline, bindings));
            context.resources.push(context.commands, pipeline,
                                   Constants{{int(from.width), int(from.height)}, {int(to.width), int(to.height)}});
            // Doubling: an invocation for each gap between source pixels, those outside the border included.
            const std::uint32_t columns = doubling ? from.width + 1 : to.width,
                                rows = doubling ? from.height + 1 : to.height;
            context.device.vk.vkCmdDispatch(context.commands, (columns + 7) / 8, (rows + 7) / 8, 1);
            return {};
        });
}

} // namespace sunfleck::render

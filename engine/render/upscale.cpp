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
    SUNFLECK_ASSIGN(pass.pipeline_, pipelines.compute(description));
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
            SUNFLECK_TRY(context.resources.bind(context.commands, *pipeline_, bindings));
            context.resources.push(context.commands, *pipeline_,
                                   Constants{{int(from.width), int(from.height)}, {int(to.width), int(to.height)}});
            context.device.vk.vkCmdDispatch(context.commands, (to.width + 7) / 8, (to.height + 7) / 8, 1);
            return {};
        });
}

} // namespace sunfleck::render

#include "gi_module/transfer/transfer_pass.h"

#include "engine/gpu/rendering.h"
#include "engine/scene/camera_shared.h"
#include "gi_module/transfer/transfer_shared.h"

#include <cstring>

namespace sunfleck::gi {
namespace {

constexpr VkFormat drawn_format = VK_FORMAT_R16G16B16A16_SFLOAT;

PixelArea covered(const std::vector<TransferDraw>& draws, const gpu::UploadSlice& camera,
                  const GBufferInput& g_buffer) {
    std::vector<Bounds> boxes;
    boxes.reserve(draws.size());
    for (const TransferDraw& draw : draws)
        boxes.push_back(draw.item.bounds);
    return covered_pixels(boxes, camera, g_buffer.width, g_buffer.height);
}

} // namespace

Result<std::unique_ptr<TransferPass>> TransferPass::create(gpu::Device& device, gpu::PipelineStore& pipelines) {
    std::unique_ptr<TransferPass> pass(new TransferPass(device));
    VkSamplerCreateInfo sampler{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
    SUNFLECK_VK(device.vk.vkCreateSampler(device.handle(), &sampler, nullptr, &pass->sampler_), "creating a sampler");
    gpu::GraphicsDescription drawing;
    drawing.vertex_shader = "gi_module/transfer/transfer.vert";
    drawing.fragment_shader = "gi_module/transfer/transfer.frag";
    drawing.attributes = {{0, VK_FORMAT_R32G32B32_SFLOAT, 12}};
    drawing.colour_formats = {drawn_format};
    SUNFLECK_ASSIGN(pass->draw_, pipelines.graphics(drawing));
    return pass;
}

TransferPass::~TransferPass() {
    device_.vk.vkDestroySampler(device_.handle(), sampler_, nullptr);
}

void TransferPass::add_passes(gpu::FrameGraph& graph, const std::vector<TransferDraw>& draws, LightTarget& target) {
    target.area = draws.empty() ? PixelArea() : covered(draws, target.camera, target.g_buffer);
    if (target.area.width == 0 || target.area.height == 0)
        return;
    graph.add_pass("transfer")
        .read(target.g_buffer.depth, gpu::Usage::sampled)
        .read(target.g_buffer.surface, gpu::Usage::sampled)
        .write(target.irradiance, gpu::Usage::colour_attachment)
        .execute([this, &draws, gpu_scene = &target.gpu_scene, g_buffer = target.g_buffer, camera = target.camera,
                  irradiance = target.irradiance, area = target.area](gpu::PassContext& context) {
            return draw(context, {*gpu_scene, g_buffer, camera, irradiance, area}, draws);
        });
}

Status TransferPass::draw(gpu::PassContext& context, const LightTarget& target,
                          const std::vector<TransferDraw>& draws) const {
    const scene::GpuScene& scene = target.gpu_scene;
    const GBufferInput& g_buffer = target.g_buffer;
    const VkRenderingAttachmentInfo colour =
        gpu::rendering_attachment(context.graph.view(target.irradiance), VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
    VkRenderingInfo rendering{VK_STRUCTURE_TYPE_RENDERING_INFO};
    rendering.renderArea = {{int(target.area.x), int(target.area.y)}, {target.area.width, target.area.height}};
    rendering.layerCount = 1;
    rendering.colorAttachmentCount = 1;
    rendering.pColorAttachments = &colour;
    const gpu::DeviceFunctions& vk = context.device.vk;
    gpu::begin_rendering(vk, context.commands, rendering, g_buffer.width, g_buffer.height);
    const VkBuffer vertices = scene.positions().handle();
    const VkDeviceSize offset = 0;
    vk.vkCmdBindVertexBuffers(context.commands, 0, 1, &vertices, &offset);
    vk.vkCmdBindIndexBuffer(context.commands, scene.indices().handle(), 0, VK_INDEX_TYPE_UINT32);
    Status status;
    for (const TransferDraw& draw : draws) {
        const gpu::Binding bindings[] = {gpu::Binding::uniform(target.camera), gpu::Binding::storage(scene.rows()),
                                         gpu::Binding::storage(draw.irradiance),
                                         gpu::Binding::sampled_image(context.graph.view(g_buffer.depth), sampler_),
                                         gpu::Binding::sampled_image(context.graph.view(g_buffer.surface), sampler_)};
        status = context.resources.bind(context.commands, *draw_, bindings);
        if (status)
            status = context.resources.push(context.commands, *draw_,
                                            shared::TransferConstants{draw.item.row, draw.item.vertex_offset});
        if (!status)
            break;
        vk.vkCmdDrawIndexed(context.commands, draw.item.index_count, 1, draw.item.first_index, draw.item.vertex_offset,
                            0);
    }
    vk.vkCmdEndRendering(context.commands);
    return status;
}

} // namespace sunfleck::gi

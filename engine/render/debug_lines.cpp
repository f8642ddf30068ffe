#include "engine/render/debug_lines.h"

#include "engine/gpu/rendering.h"

#include <bit>

namespace sunfleck::render {

Result<DebugLines> DebugLines::create(gpu::PipelineStore& pipelines, VkFormat target_format) {
    gpu::GraphicsDescription description;
    description.vertex_shader = "engine/render/debug_lines.vert";
    description.fragment_shader = "engine/render/debug_lines.frag";
    description.attributes = {{0, VK_FORMAT_R32G32B32A32_SFLOAT, 16}};
    description.colour_formats = {target_format};
    description.depth_format = depth_format;
    description.depth_write = false;
    description.depth_compare = VK_COMPARE_OP_GREATER_OR_EQUAL;
    description.topology = VK_PRIMITIVE_TOPOLOGY_LINE_LIST;
    DebugLines lines;
    SUNFLECK_ASSIGN(lines.pipeline_, pipelines.graphics(description));
    return lines;
}

void DebugLines::line(vec3 from, vec3 to, vec3 colour) {
    const float packed = std::bit_cast<float>(glm::packUnorm4x8(vec4(colour, 1.0f)));
    vertices_.emplace_back(from, packed);
    vertices_.emplace_back(to, packed);
}

void DebugLines::box(const Bounds& bounds, vec3 colour) {
    const auto corner = [&](int i) {
        return vec3(i & 1 ? bounds.maximum.x : bounds.minimum.x, i & 2 ? bounds.maximum.y : bounds.minimum.y,
                    i & 4 ? bounds.maximum.z : bounds.minimum.z);
    };
    for (int i = 0; i < 8; ++i)
        for (const int bit : {1, 2, 4})
            if ((i & bit) == 0)
                line(corner(i), corner(i | bit), colour);
}

void DebugLines::add(gpu::FrameGraph& graph, const GBuffer& g_buffer, const gpu::UploadSlice& camera,
                     gpu::ResourceId target) const {
    if (vertices_.empty())
        return;
    graph.add_pass("debug lines")
        .write(g_buffer.depth, gpu::Usage::depth_attachment)
        .write(target, gpu::Usage::colour_attachment)
        .execute([this, g_buffer, camera, target](gpu::PassContext& context) -> Status {
            SUNFLECK_ASSIGN(const gpu::UploadSlice slice, context.resources.upload(std::span<const vec4>(vertices_)));
            const auto colour =
                gpu::rendering_attachment(context.graph.view(target), VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, true);
            const auto depth = gpu::rendering_attachment(context.graph.view(g_buffer.depth),
                                                         VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL, true);
            VkRenderingInfo rendering{VK_STRUCTURE_TYPE_RENDERING_INFO};
            rendering.renderArea.extent = {g_buffer.width, g_buffer.height};
            rendering.layerCount = 1;
            rendering.colorAttachmentCount = 1;
            rendering.pColorAttachments = &colour;
            rendering.pDepthAttachment = &depth;
            const gpu::DeviceFunctions& vk = context.device.vk;
            gpu::begin_rendering(vk, context.commands, rendering, g_buffer.width, g_buffer.height);
            const gpu::Binding binding = gpu::Binding::uniform(camera);
            const Status status = context.resources.bind(context.commands, *pipeline_, {&binding, 1});
            vk.vkCmdBindVertexBuffers(context.commands, 0, 1, &slice.buffer, &slice.offset);
            vk.vkCmdDraw(context.commands, std::uint32_t(vertices_.size()), 1, 0, 0);
            vk.vkCmdEndRendering(context.commands);
            return status;
        });
}

} // namespace sunfleck::render

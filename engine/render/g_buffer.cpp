#include "engine/render/g_buffer.h"

#include "engine/gpu/rendering.h"

#include <algorithm>
#include <cstring>

namespace sunfleck::render {

Result<GBufferPass> GBufferPass::create(gpu::PipelineStore& pipelines) {
    gpu::GraphicsDescription description;
    description.vertex_shader = "engine/render/g_buffer.vert";
    description.fragment_shader = "engine/render/g_buffer.frag";
    description.bindings = {gpu::BindingKind::uniform_buffer, gpu::BindingKind::storage_buffer};
    description.attributes = {{0, VK_FORMAT_R32G32B32_SFLOAT, 12}, {1, VK_FORMAT_R32G32B32_SFLOAT, 12}};
    description.colour_formats = {normals_format, surface_format, albedo_format, motion_format};
    description.depth_format = depth_format;
    GBufferPass pass;
    for (std::uint32_t kind = 0; kind < pattern_kinds; ++kind) {
        description.specialization = {kind};
        description.colour_formats = {normals_format, surface_format, albedo_format, motion_format};
        SUNFLECK_ASSIGN(pass.with_motion_[kind], pipelines.graphics(description));
        description.colour_formats.pop_back();
        SUNFLECK_ASSIGN(pass.without_motion_[kind], pipelines.graphics(description));
    }
    return pass;
}

namespace {

bool outside(const mat4& view_projection, const Bounds& bounds) {
    // Outside of one plane of the view with all corners. Reverse Z: the near plane is z = w, the far one at infinity.
    int left = 0, right = 0, below = 0, above = 0, behind = 0;
    for (int i = 0; i < 8; ++i) {
        const vec3 corner(i & 1 ? bounds.maximum.x : bounds.minimum.x, i & 2 ? bounds.maximum.y : bounds.minimum.y,
                          i & 4 ? bounds.maximum.z : bounds.minimum.z);
        const vec4 clip = view_projection * vec4(corner, 1.0f);
        left += clip.x < -clip.w;
        right += clip.x > clip.w;
        below += clip.y < -clip.w;
        above += clip.y > clip.w;
        behind += clip.w < 0.0f;
    }
    return left == 8 || right == 8 || below == 8 || above == 8 || behind == 8;
}

// What the camera may see, nearest first: what is hidden by then is not shaded.
std::vector<const scene::DrawItem*> visible_from(const shared::CameraRow& camera,
                                                 const std::vector<scene::DrawItem>& draws) {
    std::vector<std::pair<float, const scene::DrawItem*>> seen;
    const vec3 eye(camera.position);
    for (const scene::DrawItem& item : draws)
        if (!outside(camera.view_projection, item.bounds)) {
            const vec3 nearest = glm::clamp(eye, item.bounds.minimum, item.bounds.maximum);
            seen.emplace_back(glm::length(nearest - eye), &item);
        }
    std::stable_sort(seen.begin(), seen.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<const scene::DrawItem*> result;
    for (const auto& [distance, item] : seen)
        result.push_back(item);
    return result;
}

} // namespace

GBuffer GBufferPass::add(gpu::FrameGraph& graph, const scene::GpuScene& scene, const gpu::UploadSlice& camera,
                         std::uint32_t width, std::uint32_t height, bool motion) const {
    GBuffer target;
    target.width = width;
    target.height = height;
    target.depth = graph.create_image("depth", depth_format, width, height);
    target.normals = graph.create_image("normals", normals_format, width, height);
    target.surface = graph.create_image("surface ids", surface_format, width, height);
    target.albedo = graph.create_image("albedo", albedo_format, width, height);
    if (motion)
        target.motion = graph.create_image("motion", motion_format, width, height);
    auto pass = graph.add_pass("g-buffer");
    if (motion)
        pass.write(target.motion, gpu::Usage::colour_attachment);
    pass.write(target.depth, gpu::Usage::depth_attachment)
        .write(target.normals, gpu::Usage::colour_attachment)
        .write(target.surface, gpu::Usage::colour_attachment)
        .write(target.albedo, gpu::Usage::colour_attachment)
        .execute([this, &scene, camera, target](gpu::PassContext& context) {
            return record(context, scene, camera, target);
        });
    return target;
}

Status GBufferPass::record(gpu::PassContext& context, const scene::GpuScene& scene, const gpu::UploadSlice& camera,
                           const GBuffer& target) const {
    const auto attachment = [&](gpu::ResourceId id, VkImageLayout layout) {
        return gpu::rendering_attachment(context.graph.view(id), layout);
    };
    const VkImageLayout colour = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
    std::vector<VkRenderingAttachmentInfo> colours = {
        attachment(target.normals, colour), attachment(target.surface, colour), attachment(target.albedo, colour)};
    if (target.motion.valid())
        colours.push_back(attachment(target.motion, colour));
    const auto& pipelines = target.motion.valid() ? with_motion_ : without_motion_;
    const VkRenderingAttachmentInfo depth = attachment(target.depth, VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL);
    VkRenderingInfo rendering{VK_STRUCTURE_TYPE_RENDERING_INFO};
    rendering.renderArea.extent = {target.width, target.height};
    rendering.layerCount = 1;
    rendering.colorAttachmentCount = std::uint32_t(colours.size());
    rendering.pColorAttachments = colours.data();
    rendering.pDepthAttachment = &depth;
    const VolkDeviceTable& vk = context.device.vk;
    vk.vkCmdBeginRendering(context.commands, &rendering);
    const VkViewport viewport{0, 0, float(target.width), float(target.height), 0, 1};
    vk.vkCmdSetViewport(context.commands, 0, 1, &viewport);
    vk.vkCmdSetScissor(context.commands, 0, 1, &rendering.renderArea);
    Status status;
    if (!scene.draws().empty()) {
        const gpu::Binding bindings[] = {gpu::Binding::slice(camera), gpu::Binding::slice(scene.rows())};
        const VkBuffer buffers[] = {scene.positions().handle(), scene.normals().handle()};
        const VkDeviceSize offsets[] = {0, 0};
        vk.vkCmdBindVertexBuffers(context.commands, 0, 2, buffers, offsets);
        vk.vkCmdBindIndexBuffer(context.commands, scene.indices().handle(), 0, VK_INDEX_TYPE_UINT32);
        shared::CameraRow row;
        std::memcpy(&row, camera.data, sizeof row);
        std::uint32_t bound = pattern_kinds;
        for (const scene::DrawItem* item : visible_from(row, scene.draws())) {
            const std::uint32_t kind = std::min(item->pattern, pattern_kinds - 1);
            if (kind != bound && status)
                status = context.resources.bind(context.commands, *pipelines[kind], bindings);
            bound = kind;
            vk.vkCmdDrawIndexed(context.commands, item->index_count, 1, item->first_index, item->vertex_offset,
                                item->row);
        }
    }
    vk.vkCmdEndRendering(context.commands);
    return status;
}

} // namespace sunfleck::render

#include "engine/render/g_buffer.h"

#include "engine/gpu/rendering.h"
#include "engine/render/visible_draws.h"

#include <algorithm>
#include <cstring>

namespace sunfleck::render {

namespace {

// Surfaces with textures read more of a vertex, and three textures.
void describe_kind(std::uint32_t kind, bool motion, bool extra_images, gpu::GraphicsDescription& description) {
    const bool textured = kind >= scene::surface_kind_textured;
    description.vertex_shader = textured ? "engine/render/g_buffer_textured.vert" : "engine/render/g_buffer.vert";
    description.fragment_shader = textured ? "engine/render/g_buffer_textured.frag" : "engine/render/g_buffer.frag";
    description.attributes = {{0, VK_FORMAT_R32G32B32_SFLOAT, 12}, {1, VK_FORMAT_R32G32B32_SFLOAT, 12}};
    description.specialization = {kind, motion};
    if (!textured)
        return;
    description.attributes.push_back({2, VK_FORMAT_R32G32B32A32_SFLOAT, 16});
    description.attributes.push_back({3, VK_FORMAT_R32G32B32A32_SFLOAT, 16});
    description.attributes.push_back({4, VK_FORMAT_R8G8B8A8_UNORM, 4});
    description.specialization = {kind == scene::surface_kind_holes, motion, extra_images};
}

} // namespace

Result<GBufferPass> GBufferPass::create(gpu::PipelineStore& pipelines) {
    GBufferPass pass;
    gpu::GraphicsDescription description;
    description.depth_format = depth_format;
    description.dynamic_cull = true;
    for (std::uint32_t kind = 0; kind < scene::surface_kinds; ++kind) {
        describe_kind(kind, false, false, description);
        description.colour_formats = {normals_format, surface_format, albedo_format};
        SUNFLECK_ASSIGN(pass.pipelines_[nothing][kind], pipelines.graphics(description));
        describe_kind(kind, true, false, description);
        description.colour_formats.push_back(motion_format);
        SUNFLECK_ASSIGN(pass.pipelines_[motion][kind], pipelines.graphics(description));
        describe_kind(kind, true, true, description);
        description.colour_formats.push_back(emission_format);
        description.colour_formats.push_back(gloss_format);
        SUNFLECK_ASSIGN(pass.pipelines_[emission_and_gloss][kind], pipelines.graphics(description));
    }
    return pass;
}

namespace {

bool same_bindings(const scene::DrawItem& a, const scene::DrawItem& b) {
    return a.kind == b.kind && std::equal(std::begin(a.textures), std::end(a.textures), std::begin(b.textures));
}

std::vector<gpu::Binding> bindings_of(const scene::DrawItem& item, const scene::GpuScene& scene,
                                      const gpu::UploadSlice& camera) {
    std::vector<gpu::Binding> bindings = {gpu::Binding::uniform(camera), gpu::Binding::storage(scene.rows())};
    if (item.kind < scene::surface_kind_textured)
        return bindings;
    bindings.push_back(gpu::Binding::storage(scene.materials()));
    for (const std::int32_t texture : item.textures)
        bindings.push_back(scene.textures().binding(texture));
    return bindings;
}

} // namespace

GBuffer GBufferPass::add(gpu::FrameGraph& graph, const scene::GpuScene& scene, const gpu::UploadSlice& camera,
                         std::uint32_t width, std::uint32_t height, bool with_motion) const {
    GBuffer target;
    target.width = width;
    target.height = height;
    target.depth = graph.create_image("depth", depth_format, width, height);
    target.normals = graph.create_image("normals", normals_format, width, height);
    target.surface = graph.create_image("surface ids", surface_format, width, height);
    target.albedo = graph.create_image("albedo", albedo_format, width, height);
    const bool with_extras = scene.has_emission_textures() || scene.has_gloss_textures();
    if (with_motion || with_extras)
        target.motion = graph.create_image("motion", motion_format, width, height);
    if (with_extras) {
        target.emission = graph.create_image("emission", emission_format, width, height);
        target.gloss = graph.create_image("gloss", gloss_format, width, height);
    }
    auto pass = graph.add_pass("g-buffer");
    for (const gpu::ResourceId extra : {target.motion, target.emission, target.gloss})
        if (extra.valid())
            pass.write(extra, gpu::Usage::colour_attachment);
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
    if (target.emission.valid()) {
        colours.push_back(attachment(target.emission, colour));
        colours.push_back(attachment(target.gloss, colour));
    }
    colours[0].loadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE; // normals: nobody reads them where no surface is
    const Extra extra = target.emission.valid() ? emission_and_gloss : target.motion.valid() ? motion : nothing;
    const VkRenderingAttachmentInfo depth = attachment(target.depth, VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL);
    VkRenderingInfo rendering{VK_STRUCTURE_TYPE_RENDERING_INFO};
    rendering.renderArea.extent = {target.width, target.height};
    rendering.layerCount = 1;
    rendering.colorAttachmentCount = std::uint32_t(colours.size());
    rendering.pColorAttachments = colours.data();
    rendering.pDepthAttachment = &depth;
    gpu::begin_rendering(context.device.vk, context.commands, rendering, target.width, target.height);
    const Status status = scene.draws().empty() ? Status() : draw(context, scene, camera, extra);
    context.device.vk.vkCmdEndRendering(context.commands);
    return status;
}

Status GBufferPass::draw(gpu::PassContext& context, const scene::GpuScene& scene, const gpu::UploadSlice& camera,
                         Extra extra) const {
    const gpu::DeviceFunctions& vk = context.device.vk;
    const VkBuffer buffers[] = {scene.positions().handle(), scene.normals().handle(),
                                scene.texture_coordinates().handle(), scene.tangents().handle(),
                                scene.colours().handle()};
    const VkDeviceSize offsets[5] = {};
    vk.vkCmdBindVertexBuffers(context.commands, 0, 5, buffers, offsets);
    vk.vkCmdBindIndexBuffer(context.commands, scene.indices().handle(), 0, VK_INDEX_TYPE_UINT32);
    shared::CameraRow row;
    std::memcpy(&row, camera.data, sizeof row);
    const scene::DrawItem* bound = nullptr;
    VkCullModeFlags cull = VK_CULL_MODE_NONE;
    VkFrontFace front = VK_FRONT_FACE_COUNTER_CLOCKWISE;
    vk.vkCmdSetCullMode(context.commands, cull);
    vk.vkCmdSetFrontFace(context.commands, front);
    for (const scene::DrawItem* item : visible_from(row, scene.draws())) {
        const gpu::Pipeline& pipeline = *pipelines_[extra][item->kind];
        if (bound == nullptr || !same_bindings(*bound, *item))
            SUNFLECK_TRY(context.resources.bind(context.commands, pipeline, bindings_of(*item, scene, camera)));
        bound = item;
        if (const VkCullModeFlags hidden = hidden_faces(row, *item); hidden != cull)
            vk.vkCmdSetCullMode(context.commands, cull = hidden);
        if (const VkFrontFace side = front_face(*item); side != front)
            vk.vkCmdSetFrontFace(context.commands, front = side);
        SUNFLECK_TRY(context.resources.push(context.commands, pipeline, item->constants));
        vk.vkCmdDrawIndexed(context.commands, item->index_count, 1, item->first_index, item->vertex_offset, 0);
    }
    return {};
}

} // namespace sunfleck::render

#include "engine/render/composition.h"

#include "engine/core/divide_up.h"
#include "engine/gpu/compute_pass.h"
#include "engine/gpu/rendering.h"
#include "engine/render/tone_map.h"

namespace sunfleck::render {

Result<CompositionPass> CompositionPass::create(gpu::Device& device, gpu::PipelineStore& pipelines,
                                                VkFormat display_format) {
    CompositionPass pass;
    gpu::ComputeDescription views;
    views.shader = "engine/render/composition.comp";
    gpu::GraphicsDescription final;
    final.vertex_shader = "engine/render/composition.vert";
    final.fragment_shader = "engine/render/composition.frag";
    final.colour_formats = {display_format};
    for (const std::uint32_t emission : {0, 1})
        for (const std::uint32_t sky : {0, 1}) {
            views.specialization = {emission, sky};
            SUNFLECK_ASSIGN(pass.views_[emission][sky], pipelines.compute(views));
        }
    for (const std::uint32_t emission : {0, 1})
        for (const std::uint32_t brightness : {0, 1})
            for (const std::uint32_t glare : {0, 1}) {
                final.specialization = {emission, 0, brightness, glare};
                SUNFLECK_ASSIGN(pass.final_[emission][brightness][glare], pipelines.graphics(final));
            }
    final.depth_format = depth_format; // 0 where no surface is, which is the depth of the triangle
    final.depth_compare = VK_COMPARE_OP_EQUAL;
    final.depth_write = false;
    for (const std::uint32_t brightness : {0, 1})
        for (const std::uint32_t glare : {0, 1}) {
            final.specialization = {0, 1, brightness, glare};
            SUNFLECK_ASSIGN(pass.sky_[brightness][glare], pipelines.graphics(final));
        }
    gpu::GraphicsDescription emission;
    emission.vertex_shader = "engine/render/composition_emission.vert";
    emission.fragment_shader = "engine/render/composition_emission.frag";
    emission.attributes = {{0, VK_FORMAT_R32G32B32_SFLOAT, 12}};
    emission.colour_formats = {display_format};
    for (const std::uint32_t brightness : {0, 1})
        for (const std::uint32_t glare : {0, 1}) {
            emission.specialization = {0, 0, brightness, glare};
            SUNFLECK_ASSIGN(pass.emission_[brightness][glare], pipelines.graphics(emission));
        }
    VkSamplerCreateInfo sampler{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
    SUNFLECK_VK(device.vk.vkCreateSampler(device.handle(), &sampler, nullptr, &pass.sampler_), "creating a sampler");
    sampler.magFilter = sampler.minFilter = VK_FILTER_LINEAR;
    sampler.addressModeU = sampler.addressModeV = sampler.addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
    SUNFLECK_VK(device.vk.vkCreateSampler(device.handle(), &sampler, nullptr, &pass.linear_), "creating a sampler");
    return pass;
}

void CompositionPass::destroy(gpu::Device& device) {
    for (VkSampler* sampler : {&sampler_, &linear_}) {
        device.vk.vkDestroySampler(device.handle(), *sampler, nullptr);
        *sampler = VK_NULL_HANDLE;
    }
}

void CompositionPass::add(gpu::FrameGraph& graph, const scene::GpuScene& scene, const GBuffer& g_buffer,
                          const CompositionInput& input, const gpu::UploadSlice& camera, gpu::ResourceId output) const {
    if (input.view == shared::view_final && input.tone_map)
        add_final(graph, scene, g_buffer, input, camera, output);
    else
        add_view(graph, scene, g_buffer, input, camera, output);
}

shared::CompositionConstants composition_constants(const GBuffer& g_buffer, const CompositionInput& input) {
    shared::CompositionConstants constants{};
    constants.view = input.view;
    constants.tone_map = input.tone_map ? 1 : 0;
    constants.exposure = shared::exposure_factor(input.ev100);
    constants.width = g_buffer.width;
    constants.height = g_buffer.height;
    constants.sky_red = input.sky.x;
    constants.sky_green = input.sky.y;
    constants.sky_blue = input.sky.z;
    constants.sky_rotation = input.sky_rotation;
    constants.glare_share = input.glare_share;
    constants.has_gloss = input.specular.valid() ? 1 : 0;
    return constants;
}

namespace {

bool sky_has_picture(const CompositionInput& input) {
    return input.sky_image != nullptr && *input.sky_image;
}

} // namespace

void CompositionPass::add_final(gpu::FrameGraph& graph, const scene::GpuScene& scene, const GBuffer& g_buffer,
                                const CompositionInput& input, const gpu::UploadSlice& camera,
                                gpu::ResourceId output) const {
    const bool emission_image = g_buffer.emission.valid();
    auto pass = graph.add_pass("composition");
    pass.read(input.irradiance, gpu::Usage::sampled)
        .read(g_buffer.albedo, gpu::Usage::sampled)
        .read(emission_image ? g_buffer.emission : g_buffer.surface, gpu::Usage::sampled)
        .read(input.glare.valid() ? input.glare : g_buffer.albedo, gpu::Usage::sampled)
        .read(input.specular.valid() ? input.specular : g_buffer.albedo, gpu::Usage::sampled);
    if (sky_has_picture(input))
        pass.read(g_buffer.depth, gpu::Usage::depth_attachment);
    pass.write(output, gpu::Usage::colour_attachment)
        .execute([this, &scene, g_buffer, input, camera, output, emission_image](gpu::PassContext& context) -> Status {
            const gpu::Pipeline& kernel = *final_[emission_image][input.alpha_is_brightness][input.glare.valid()];
            auto target =
                gpu::rendering_attachment(context.graph.view(output), VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
            target.loadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE; // every pixel is written
            VkRenderingInfo rendering{VK_STRUCTURE_TYPE_RENDERING_INFO};
            rendering.renderArea.extent = {g_buffer.width, g_buffer.height};
            rendering.layerCount = 1;
            rendering.colorAttachmentCount = 1;
            rendering.pColorAttachments = &target;
            const gpu::DeviceFunctions& vk = context.device.vk;
            gpu::begin_rendering(vk, context.commands, rendering, g_buffer.width, g_buffer.height);
            Status status = draw_all(context, kernel, g_buffer, input, camera);
            if (status && !emission_image)
                status = draw_emission(context, scene, g_buffer, input, camera);
            vk.vkCmdEndRendering(context.commands);
            if (!status || !sky_has_picture(input))
                return status;
            target.loadOp = VK_ATTACHMENT_LOAD_OP_LOAD;
            const auto depth = gpu::rendering_attachment(context.graph.view(g_buffer.depth),
                                                         VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL, true);
            rendering.pDepthAttachment = &depth;
            gpu::begin_rendering(vk, context.commands, rendering, g_buffer.width, g_buffer.height);
            status = draw_all(context, *sky_[input.alpha_is_brightness][input.glare.valid()], g_buffer, input, camera);
            vk.vkCmdEndRendering(context.commands);
            return status;
        });
}

Status CompositionPass::draw_all(gpu::PassContext& context, const gpu::Pipeline& kernel, const GBuffer& g_buffer,
                                 const CompositionInput& input, const gpu::UploadSlice& camera) const {
    const auto image = [&](gpu::ResourceId id) {
        return gpu::Binding::sampled_image(context.graph.view(id), sampler_);
    };
    // Bound, but not read, where there is none.
    const gpu::Binding bindings[] = {image(input.irradiance),
                                     image(g_buffer.albedo),
                                     image(g_buffer.emission.valid() ? g_buffer.emission : g_buffer.albedo),
                                     input.sky_image != nullptr ? input.sky_image->binding() : image(g_buffer.albedo),
                                     gpu::Binding::uniform(camera),
                                     glare_binding(context, g_buffer, input),
                                     image(input.specular.valid() ? input.specular : g_buffer.albedo)};
    SUNFLECK_TRY(context.resources.bind(context.commands, kernel, bindings));
    SUNFLECK_TRY(context.resources.push(context.commands, kernel, composition_constants(g_buffer, input)));
    context.device.vk.vkCmdDraw(context.commands, 3, 1, 0, 0);
    return {};
}

gpu::Binding CompositionPass::glare_binding(gpu::PassContext& context, const GBuffer& g_buffer,
                                            const CompositionInput& input) const {
    return gpu::Binding::sampled_image(context.graph.view(input.glare.valid() ? input.glare : g_buffer.albedo),
                                       linear_);
}

Status CompositionPass::draw_emission(gpu::PassContext& context, const scene::GpuScene& scene, const GBuffer& g_buffer,
                                      const CompositionInput& input, const gpu::UploadSlice& camera) const {
    const gpu::Pipeline& kernel = *emission_[input.alpha_is_brightness][input.glare.valid()];
    const float exposure = shared::exposure_factor(input.ev100);
    bool bound = false;
    for (const scene::DrawItem& item : scene.draws()) {
        const shared::DrawConstants& draw = item.constants;
        if ((draw.surface & shared::surface_emits) == 0 || (draw.surface & shared::surface_unlit) != 0)
            continue;
        if (!bound) {
            const auto image = [&](gpu::ResourceId id) {
                return gpu::Binding::sampled_image(context.graph.view(id), sampler_);
            };
            const gpu::Binding bindings[] = {image(input.irradiance), image(g_buffer.albedo), image(g_buffer.surface),
                                             gpu::Binding::uniform(camera), glare_binding(context, g_buffer, input)};
            SUNFLECK_TRY(context.resources.bind(context.commands, kernel, bindings));
            const VkBuffer positions = scene.positions().handle();
            const VkDeviceSize offset = 0;
            context.device.vk.vkCmdBindVertexBuffers(context.commands, 0, 1, &positions, &offset);
            context.device.vk.vkCmdBindIndexBuffer(context.commands, scene.indices().handle(), 0, VK_INDEX_TYPE_UINT32);
            bound = true;
        }
        const shared::EmissionConstants constants{{draw.model[0], draw.model[1], draw.model[2]},
                                                  vec4(vec3(draw.emission), exposure),
                                                  draw.surface,
                                                  input.glare_share};
        SUNFLECK_TRY(context.resources.push(context.commands, kernel, constants));
        context.device.vk.vkCmdDrawIndexed(context.commands, item.index_count, 1, item.first_index, item.vertex_offset,
                                           0);
    }
    return {};
}

void CompositionPass::add_view(gpu::FrameGraph& graph, const scene::GpuScene& scene, const GBuffer& g_buffer,
                               const CompositionInput& input, const gpu::UploadSlice& camera,
                               gpu::ResourceId output) const {
    const shared::CompositionConstants constants = composition_constants(g_buffer, input);
    const bool emission_image = g_buffer.emission.valid();
    // Images that there are not must be bound all the same; others stand in for them, unread.
    const gpu::ResourceId stand_in = g_buffer.albedo;
    gpu::ComputePass pass(graph, "composition", *views_[emission_image ? 1 : 0][sky_has_picture(input) ? 1 : 0]);
    pass.sampled(input.irradiance, sampler_)
        .sampled(g_buffer.depth, sampler_)
        .sampled(g_buffer.normals, sampler_)
        .sampled(g_buffer.surface, sampler_)
        .sampled(g_buffer.albedo, sampler_)
        .sampled(g_buffer.motion.valid() ? g_buffer.motion : stand_in, sampler_)
        .sampled(emission_image ? g_buffer.emission : stand_in, sampler_)
        .storage_read(scene.rows())
        .storage_write(output)
        .uniform(camera);
    if (input.sky_image != nullptr)
        pass.constant(input.sky_image->binding());
    else
        pass.sampled(stand_in, sampler_);
    pass.sampled(input.specular.valid() ? input.specular : stand_in, sampler_);
    pass.push(constants).dispatch(divide_up(constants.width, 8), divide_up(constants.height, 8));
}

} // namespace sunfleck::render

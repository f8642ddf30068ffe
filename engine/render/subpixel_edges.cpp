#include "engine/render/subpixel_edges.h"

#include "engine/core/divide_up.h"
#include "engine/gpu/compute_pass.h"
#include "engine/gpu/rendering.h"
#include "engine/render/enlargement.h"
#include "engine/render/tone_map.h"
#include "engine/render/visible_draws.h"
#include "engine/scene/pattern_shared.h"

#include <algorithm>
#include <cstring>

namespace sunfleck::render {
namespace {

constexpr std::uint32_t samples = 4;                                 // of a pixel: sample_places in the shader
constexpr VkFormat sample_surface_format = VK_FORMAT_R8G8B8A8_UNORM; // sample_surface.glsl
constexpr std::uint32_t shown_columns = 64, shown_run = 8;           // of shown_surfaces.comp
constexpr VkDeviceSize word = 4, list_words = 4, edge_list = 0, detail_list = 1; // of subpixel_places.glsl

struct ListedConstants {
    EnlargementSizes sizes;
    float exposed; // from irradiance to what a white surface reflects of it, exposed
};

bool has_holes(const scene::DrawItem& item) {
    return item.kind == scene::surface_kind_holes;
}
bool emits(const scene::DrawItem& item) {
    return (item.constants.surface & shared::surface_emits) != 0;
}

// A texture or a pattern makes its albedo differ from place to place, and light shows that. (Of what is blended, the
// picture shows what is behind, too.)
bool is_detailed(const scene::DrawItem& item) {
    constexpr std::uint32_t others = shared::surface_emits | shared::surface_unlit | shared::surface_stippled;
    const bool varies =
        item.kind < scene::surface_kind_textured ? item.kind != shared::pattern_none : item.textures[0] >= 0;
    return varies && (item.constants.surface & others) == 0;
}

} // namespace

Result<std::unique_ptr<SubpixelEdges>> SubpixelEdges::create(gpu::Device& device, gpu::PipelineStore& pipelines) {
    std::unique_ptr<SubpixelEdges> result(new SubpixelEdges(device));
    const VkSamplerCreateInfo sampler{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO}; // for texelFetch
    SUNFLECK_VK(device.vk.vkCreateSampler(device.handle(), &sampler, nullptr, &result->sampler_), "creating a sampler");
    SUNFLECK_TRY(result->make_pipelines(pipelines));
    return result;
}

SubpixelEdges::~SubpixelEdges() {
    device_.vk.vkDestroySampler(device_.handle(), sampler_, nullptr);
}

Status SubpixelEdges::make_pipelines(gpu::PipelineStore& pipelines) {
    gpu::GraphicsDescription drawing;
    drawing.vertex_shader = "engine/render/subpixel_samples.vert";
    drawing.attributes = {
        {0, VK_FORMAT_R32G32B32_SFLOAT, 12}, {1, VK_FORMAT_R32G32B32A32_SFLOAT, 16}, {2, VK_FORMAT_R8G8B8A8_UNORM, 4}};
    drawing.colour_formats = {sample_surface_format};
    drawing.depth_format = depth_format;
    drawing.dynamic_cull = true;
    drawing.samples = samples;
    const auto make = [&](const gpu::Pipeline*& pipeline, std::vector<std::uint32_t> constants, bool colour) -> Status {
        drawing.specialization = std::move(constants);
        drawing.colour_write = colour;
        drawing.fragment_shader = colour || drawing.specialization[0] != 0 ? "engine/render/subpixel_samples.frag" : "";
        SUNFLECK_ASSIGN(pipeline, pipelines.graphics(drawing));
        return {};
    };
    for (const bool with_holes : {false, true}) {
        SUNFLECK_TRY(make(plain_[with_holes], {with_holes, 0, 0}, false));
        SUNFLECK_TRY(make(emitting_[with_holes], {with_holes, 0, 0}, true));
    }
    for (std::uint32_t kind = 1; kind < scene::surface_kinds; ++kind) {
        const bool textured = kind >= scene::surface_kind_textured;
        SUNFLECK_TRY(make(detailed_[kind], {kind == scene::surface_kind_holes, textured ? 0 : kind, textured}, true));
    }
    gpu::ComputeDescription kernel;
    kernel.shader = "engine/render/shown_surfaces.comp";
    SUNFLECK_ASSIGN(shown_, pipelines.compute(kernel));
    for (const bool doubling : {false, true}) {
        Kernels& kernels = doubling ? doubling_ : any_;
        kernel.specialization = {doubling};
        kernel.shader = "engine/render/subpixel_places.comp";
        SUNFLECK_ASSIGN(kernels.enlargement, pipelines.compute(kernel));
        for (const bool gloss : {false, true}) {
            kernel.specialization = {doubling, gloss};
            kernel.shader = "engine/render/subpixel_edges.comp";
            SUNFLECK_ASSIGN(kernels.edges[gloss], pipelines.compute(kernel));
            kernel.shader = "engine/render/texture_detail.comp";
            SUNFLECK_ASSIGN(kernels.details[gloss], pipelines.compute(kernel));
        }
    }
    return {};
}

Status SubpixelEdges::make_buffers(const scene::GpuScene& scene, std::uint32_t places, gpu::FrameResources& resources) {
    const auto make = [&](gpu::Buffer& buffer, const char* name, VkDeviceSize size,
                          VkBufferUsageFlags usage) -> Status {
        if (buffer && buffer.size() >= size)
            return {};
        if (buffer)
            resources.retire(std::move(buffer));
        gpu::BufferDescription description;
        description.name = name;
        description.size = size;
        description.usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT | usage;
        SUNFLECK_ASSIGN(buffer, gpu::Buffer::create(device_, description));
        return {};
    };
    const VkDeviceSize rows = std::max<VkDeviceSize>(scene.rows().size / sizeof(shared::InstanceRow), 1);
    SUNFLECK_TRY(make(rows_, "shown surfaces", word * rows, 0));
    return make(places_, "subpixel places", word * (2 * list_words + places), VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT);
}

Status SubpixelEdges::add(gpu::FrameGraph& graph, const scene::GpuScene& scene, const Input& input,
                          gpu::ResourceId target, gpu::FrameResources& resources) {
    const EnlargementSizes sizes(graph.description(input.picture), graph.description(target));
    const glm::uvec2 invocations = sizes.invocations(); // each lists one place at most
    SUNFLECK_TRY(make_buffers(scene, invocations.x * invocations.y, resources));
    add_clearing(graph);
    const Samples seen = add_samples(graph, scene, input, sizes.target);
    const Kernels& kernels = sizes.doubles() ? doubling_ : any_;
    gpu::ComputePass(graph, "enlargement", *kernels.enlargement)
        .storage_read(input.picture)
        .storage_write(target)
        .storage_read_write(places_)
        .sampled(input.g_buffer.albedo, sampler_)
        .sampled(seen.surface, sampler_)
        .push(sizes)
        .dispatch(divide_up(invocations.x, 8), divide_up(invocations.y, 8));
    add_listed(graph, input, target, seen, kernels);
    return {};
}

// What the enlargement has listed.
void SubpixelEdges::add_listed(gpu::FrameGraph& graph, const Input& input, gpu::ResourceId target, const Samples& seen,
                               const Kernels& kernels) const {
    const bool gloss = input.specular.valid();
    const gpu::ResourceId specular = gloss ? input.specular : input.irradiance;
    const ListedConstants constants{{graph.description(input.picture), graph.description(target)},
                                    shared::exposure_factor(input.ev100) / pi};
    gpu::ComputePass(graph, "texture detail", *kernels.details[gloss])
        .storage_read(input.picture)
        .storage_write(target)
        .storage_read(places_)
        .sampled(input.g_buffer.surface, sampler_)
        .sampled(seen.surface, sampler_)
        .sampled(input.g_buffer.albedo, sampler_)
        .sampled(input.irradiance, sampler_)
        .sampled(specular, sampler_)
        .push(constants)
        .dispatch_indirect(places_, detail_list * list_words * word);
    gpu::ComputePass(graph, "subpixel edges", *kernels.edges[gloss])
        .storage_read(input.picture)
        .storage_write(target)
        .storage_read(places_)
        .sampled(input.g_buffer.depth, sampler_)
        .sampled(input.g_buffer.normals, sampler_)
        .sampled(input.g_buffer.surface, sampler_)
        .sampled(seen.depth, sampler_)
        .sampled(seen.surface, sampler_)
        .uniform(input.camera)
        .sampled(input.g_buffer.albedo, sampler_)
        .sampled(input.irradiance, sampler_)
        .sampled(specular, sampler_)
        .push(constants)
        .dispatch_indirect(places_, edge_list * list_words * word);
}

void SubpixelEdges::add_clearing(gpu::FrameGraph& graph) const {
    graph.add_pass("subpixel edges clearing")
        .write(graph.import_buffer(rows_), gpu::Usage::transfer_destination)
        .write(graph.import_buffer(places_), gpu::Usage::transfer_destination)
        .execute([this](gpu::PassContext& context) -> Status {
            const auto fill = context.device.vk.vkCmdFillBuffer;
            fill(context.commands, rows_.handle(), 0, VK_WHOLE_SIZE, 0);
            for (const VkDeviceSize list : {edge_list, detail_list}) {
                const VkDeviceSize head = list * list_words * word; // groups: none by one by one
                fill(context.commands, places_.handle(), head, word, 0);
                fill(context.commands, places_.handle(), head + word, 2 * word, 1);
                fill(context.commands, places_.handle(), head + 3 * word, word, 0);
            }
            return {};
        });
}

SubpixelEdges::Samples SubpixelEdges::add_samples(gpu::FrameGraph& graph, const scene::GpuScene& scene,
                                                  const Input& input, glm::ivec2 size) const {
    const GBuffer& g_buffer = input.g_buffer;
    gpu::ComputePass(graph, "shown surfaces", *shown_)
        .sampled(g_buffer.surface, sampler_)
        .storage_write(rows_)
        .push(glm::ivec2(int(g_buffer.width), int(g_buffer.height)))
        .dispatch(divide_up(g_buffer.width, shown_columns), divide_up(g_buffer.height, shown_run));
    Samples seen;
    seen.width = std::uint32_t(size.x);
    seen.height = std::uint32_t(size.y);
    seen.depth = graph.create_image("depth samples", depth_format, seen.width, seen.height, 1, samples);
    seen.surface = graph.create_image("surface samples", sample_surface_format, seen.width, seen.height, 1, samples);
    graph.add_pass("subpixel samples")
        .read(graph.import_buffer(rows_), gpu::Usage::storage_read)
        .write(seen.depth, gpu::Usage::depth_attachment)
        .write(seen.surface, gpu::Usage::colour_attachment)
        .execute([this, &scene, camera = input.camera, seen](gpu::PassContext& context) {
            return record(context, scene, camera, seen);
        });
    return seen;
}

Status SubpixelEdges::record(gpu::PassContext& context, const scene::GpuScene& scene, const gpu::UploadSlice& camera,
                             const Samples& target) const {
    const VkRenderingAttachmentInfo surface = gpu::rendering_attachment(context.graph.view(target.surface),
                                                                        VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL),
                                    depth = gpu::rendering_attachment(context.graph.view(target.depth),
                                                                      VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL);
    VkRenderingInfo rendering{VK_STRUCTURE_TYPE_RENDERING_INFO};
    rendering.renderArea.extent = {target.width, target.height};
    rendering.layerCount = 1;
    rendering.colorAttachmentCount = 1;
    rendering.pColorAttachments = &surface;
    rendering.pDepthAttachment = &depth;
    gpu::begin_rendering(context.device.vk, context.commands, rendering, target.width, target.height);
    Status status = scene.draws().empty() ? Status() : draw(context, scene, camera);
    context.device.vk.vkCmdEndRendering(context.commands);
    return status;
}

// The pipeline without a fragment shader has no texture.
std::vector<gpu::Binding> SubpixelEdges::bindings_of(const gpu::Pipeline& pipeline, const scene::DrawItem& item,
                                                     const scene::GpuScene& scene,
                                                     const gpu::UploadSlice& camera) const {
    std::vector<gpu::Binding> bindings = {gpu::Binding::uniform(camera), gpu::Binding::storage(rows_),
                                          gpu::Binding::storage(scene.rows()),
                                          gpu::Binding::storage(scene.materials())};
    if (pipeline.bindings().size() > bindings.size())
        bindings.push_back(scene.textures().binding(item.textures[0]));
    return bindings;
}

Status SubpixelEdges::draw(gpu::PassContext& context, const scene::GpuScene& scene,
                           const gpu::UploadSlice& camera) const {
    const gpu::DeviceFunctions& vk = context.device.vk;
    const VkBuffer buffers[] = {scene.positions().handle(), scene.texture_coordinates().handle(),
                                scene.colours().handle()};
    const VkDeviceSize offsets[3] = {};
    vk.vkCmdBindVertexBuffers(context.commands, 0, 3, buffers, offsets);
    vk.vkCmdBindIndexBuffer(context.commands, scene.indices().handle(), 0, VK_INDEX_TYPE_UINT32);
    shared::CameraRow row;
    std::memcpy(&row, camera.data, sizeof row);
    const std::vector<const scene::DrawItem*> items = visible_from(row, scene.draws());
    for (const bool plain : {true, false}) // which write depth alone: they must not be drawn over others later
        SUNFLECK_TRY(draw_items(context, scene, camera, items, plain));
    return {};
}

const gpu::Pipeline& SubpixelEdges::pipeline_of(const scene::DrawItem& item) const {
    if (is_detailed(item))
        return *detailed_[item.kind];
    return *(emits(item) ? emitting_ : plain_)[has_holes(item)];
}

Status SubpixelEdges::draw_items(gpu::PassContext& context, const scene::GpuScene& scene,
                                 const gpu::UploadSlice& camera, std::span<const scene::DrawItem* const> items,
                                 bool plain) const {
    const gpu::DeviceFunctions& vk = context.device.vk;
    shared::CameraRow row;
    std::memcpy(&row, camera.data, sizeof row);
    const gpu::Pipeline* bound = nullptr;
    for (const scene::DrawItem* item : items) {
        if ((!emits(*item) && !is_detailed(*item)) != plain)
            continue;
        const gpu::Pipeline& pipeline = pipeline_of(*item);
        if (item->kind >= scene::surface_kind_textured || bound != &pipeline)
            SUNFLECK_TRY(
                context.resources.bind(context.commands, pipeline, bindings_of(pipeline, *item, scene, camera)));
        bound = &pipeline;
        vk.vkCmdSetCullMode(context.commands, hidden_faces(row, *item));
        vk.vkCmdSetFrontFace(context.commands, front_face(*item));
        SUNFLECK_TRY(context.resources.push(context.commands, pipeline, item->constants));
        vk.vkCmdDrawIndexed(context.commands, item->index_count, 1, item->first_index, item->vertex_offset, 0);
    }
    return {};
}

} // namespace sunfleck::render

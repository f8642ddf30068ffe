#include "gi_module/shadows/shadow_maps.h"

#include "engine/gpu/rendering.h"
#include "gi_module/shadows/map_chunk.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace sunfleck::gi {
namespace {

// Enough layers that few submissions are needed, few enough that the staging image stays small in the cache.
constexpr std::uint32_t staging_layers = 64;
constexpr std::uint64_t staging_budget_bytes = std::uint64_t(64) << 20;

// Vertex buffers: positions, then these.
constexpr std::uint32_t jobs_buffer = 1;

VkFormat depth_format(std::uint32_t bits) {
    return bits == 16 ? VK_FORMAT_D16_UNORM : VK_FORMAT_D32_SFLOAT;
}

} // namespace

Result<std::unique_ptr<ShadowMaps>> ShadowMaps::create(gpu::Device& device, gpu::PipelineStore& pipelines,
                                                       const MapNames& names) {
    std::unique_ptr<ShadowMaps> maps(new ShadowMaps(device, names));
    gpu::GraphicsDescription description;
    description.vertex_shader = "gi_module/shadows/shadow_map.vert";
    description.attributes = {{0, VK_FORMAT_R32G32B32_SFLOAT, 12}};
    for (const std::size_t offset :
         {offsetof(shared::ShadowJob, x), offsetof(shared::ShadowJob, y), offsetof(shared::ShadowJob, w),
          offsetof(shared::ShadowJob, z), offsetof(shared::ShadowJob, tile)})
        description.attributes.push_back(
            {jobs_buffer, VK_FORMAT_R32G32B32A32_SFLOAT, sizeof(shared::ShadowJob), std::uint32_t(offset), true});
    description.attributes.push_back(
        {jobs_buffer, VK_FORMAT_R32G32_UINT, sizeof(shared::ShadowJob), offsetof(shared::ShadowJob, layer_face), true});
    description.depth_clamp = true; // what is nearer than shadow_near still blocks
    for (const bool culled : {false, true}) {
        // The hemisphere's projection mirrors: what faces the light is wound clockwise on the map.
        description.cull = culled ? VK_CULL_MODE_FRONT_BIT : VK_CULL_MODE_NONE;
        description.depth_format = depth_format(16);
        SUNFLECK_ASSIGN(maps->pipelines16_[culled], pipelines.graphics(description));
        description.depth_format = depth_format(32);
        SUNFLECK_ASSIGN(maps->pipelines32_[culled], pipelines.graphics(description));
    }
    description.vertex_shader = "gi_module/shadows/shadow_map_holes.vert";
    description.fragment_shader = "gi_module/shadows/shadow_map_holes.frag";
    description.attributes.push_back({jobs_buffer + 1, VK_FORMAT_R32G32B32A32_SFLOAT, 16});
    description.attributes.push_back({jobs_buffer + 2, VK_FORMAT_R8G8B8A8_UNORM, 4});
    description.cull = VK_CULL_MODE_NONE;
    for (const std::uint32_t bits : {16u, 32u}) {
        description.depth_format = depth_format(bits);
        SUNFLECK_ASSIGN(maps->hole_pipelines_[bits / 32], pipelines.graphics(description));
    }
    return maps;
}

// A map that was to be redrawn may show movers where the lost frame found them, or still where the frame before did.
void ShadowMaps::begin_frame(bool previous_lost) {
    if (previous_lost) {
        for (const auto& [slot, areas] : shown_before_)
            movers_shown_[slot].add(areas);
        staging_.state().layout = VK_IMAGE_LAYOUT_UNDEFINED; // its content is of no use from frame to frame
    }
    shown_before_.clear();
}

Result<bool> ShadowMaps::configure(const MapLayout& layout, gpu::FrameResources& resources) {
    const std::uint32_t layers = layout.keep_static ? 2 : 1;
    const auto most_maps = [&](std::uint32_t resolution) {
        const std::uint64_t texels = std::uint64_t(resolution) * resolution, bytes = texels * layout.bits / 8;
        return std::min({layout.memory_bytes / (bytes * layers), device_.traits().max_texel_elements / texels,
                         (std::uint64_t(1) << 31) / bytes});
    };
    const std::uint32_t wanted = std::max(layout.wanted, 1u);
    std::uint32_t resolution = layout.resolution;
    while (layout.shrink && resolution > 2 && most_maps(resolution) < wanted)
        resolution -= 2;
    const std::uint32_t slots = std::uint32_t(std::min<std::uint64_t>(most_maps(resolution), wanted));
    if (slots == 0)
        return Error{"one shadow map of " + std::to_string(resolution) +
                         " texels a side does not fit shadow_memory or this device; lower shadow_map_resolution",
                     ErrorCode::memory};
    if (texels_ && resolution == resolution_ && layout.bits == bits_ && slots <= slots_ &&
        layout.keep_static == layout_.keep_static)
        return false;
    for (gpu::Buffer* buffer : {&texels_, &static_texels_})
        if (*buffer)
            resources.retire(std::move(*buffer));
    if (staging_)
        resources.retire(std::move(staging_));
    slots_ = 0;
    layout_ = layout;
    resolution_ = resolution;
    bits_ = layout.bits;
    const std::uint64_t bytes_per_map = std::uint64_t(resolution) * resolution * bits_ / 8;
    gpu::BufferDescription buffer;
    buffer.name = names_.maps;
    buffer.size = (bytes_per_map * slots + 3) / 4 * 4;
    buffer.usage = VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT |
                   VK_BUFFER_USAGE_TRANSFER_DST_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT;
    buffer.texel_format = VK_FORMAT_R32_UINT; // see map_words.glsl
    SUNFLECK_ASSIGN(texels_, gpu::Buffer::create(device_, buffer));
    if (layout.keep_static) {
        buffer.name = names_.static_maps;
        SUNFLECK_ASSIGN(static_texels_, gpu::Buffer::create(device_, buffer));
    }
    layers_ = std::uint32_t(std::clamp<std::uint64_t>(
        staging_budget_bytes / bytes_per_map, 1, std::min({staging_layers, slots, device_.traits().max_image_layers})));
    gpu::ImageDescription image;
    image.name = names_.staging;
    image.format = depth_format(bits_);
    image.width = image.height = resolution;
    image.layers = layers_;
    image.array = true;
    image.usage =
        VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    SUNFLECK_ASSIGN(staging_, gpu::Image::create(device_, image));
    slots_ = slots;
    shown_before_.clear();
    movers_shown_.assign(slots, {}); // of maps that hold nothing yet: their static part comes first
    return true;
}

// As many as there are layers, but of large scenes fewer: whoever waits for a first frame of minutes sees how many
// passes are done.
std::size_t ShadowMaps::maps_of_a_pass(const scene::GpuScene& scene, Occluders occluders) const {
    constexpr std::uint64_t most_triangles = 1u << 24; // in all maps of a pass: some seconds of a software rasteriser
    std::uint64_t triangles = 1;
    for (const scene::DrawItem& item : scene.draws())
        if (occluders == Occluders::all || item.is_static == (occluders == Occluders::static_only))
            triangles += item.index_count / 3;
    return std::size_t(std::clamp<std::uint64_t>(most_triangles / triangles, 1, layers_));
}

Status ShadowMaps::add_passes(gpu::FrameGraph& graph, const scene::GpuScene& scene, gpu::FrameResources& resources,
                              std::span<const ShadowRequest> requests, const MapOptions& options,
                              ShadowCounters& counters) {
    counters.maps += requests.size();
    const auto in_chunks = [&](std::span<const ShadowRequest> all, Occluders occluders, const gpu::Buffer& target,
                               bool over_static) -> Status {
        const std::size_t most = maps_of_a_pass(scene, occluders);
        for (std::size_t first = 0; first < all.size(); first += most) {
            const auto part = all.subspan(first, std::min(most, all.size() - first));
            SUNFLECK_ASSIGN(Chunk chunk,
                            prepare_chunk(scene, resources, part, occluders,
                                          options.detail && (over_static || options.detail_of_all), counters));
            find_copied_areas(part, over_static, chunk);
            SUNFLECK_TRY(add_drawing(graph, scene, chunk, target, over_static));
        }
        return {};
    };
    if (!options.keep_static || !static_texels_)
        return in_chunks(requests, Occluders::all, texels_, false);
    std::vector<ShadowRequest> static_stale;
    std::copy_if(requests.begin(), requests.end(), std::back_inserter(static_stale),
                 [](const ShadowRequest& request) { return request.redraw_static; });
    SUNFLECK_TRY(in_chunks(static_stale, Occluders::static_only, static_texels_, false));
    return in_chunks(requests, Occluders::movers, texels_, true);
}

// What movers cover now or covered when the map was drawn last: the rest is as static geometry left it. Notes the new.
void ShadowMaps::find_copied_areas(std::span<const ShadowRequest> requests, bool over_static, Chunk& chunk) {
    for (std::size_t layer = 0; layer < requests.size(); ++layer) {
        MapAreas& areas = chunk.areas[layer];
        if (!over_static) {
            areas.add(MapArea::all(resolution_));
            continue;
        }
        MapAreas& shown = movers_shown_[requests[layer].slot];
        shown_before_.emplace_back(requests[layer].slot, std::exchange(shown, areas));
        areas.add(shown_before_.back().second);
        if (requests[layer].redraw_static)
            areas.add(MapArea::all(resolution_));
    }
}

// Draws a chunk in the staging image, over the kept static layers or from nothing, and copies it to its slots.
Status ShadowMaps::add_drawing(gpu::FrameGraph& graph, const scene::GpuScene& scene, const Chunk& chunk,
                               const gpu::Buffer& target, bool over_static) {
    const gpu::ResourceId staging = graph.import_image(staging_);
    const gpu::ResourceId texels = graph.import_buffer(target);
    if (over_static)
        graph.add_pass(names_.copies)
            .read(graph.import_buffer(static_texels_), gpu::Usage::transfer_source)
            .write(staging, gpu::Usage::transfer_destination)
            .execute(
                [this, chunk](gpu::PassContext& context) { return copy_chunk(context, chunk, static_texels_, false); });
    graph.add_pass(names_.maps)
        .write(staging, gpu::Usage::depth_attachment)
        .execute([this, &scene, chunk, over_static](gpu::PassContext& context) {
            return draw_chunk(context, scene, chunk, over_static);
        });
    graph.add_pass(names_.copies)
        .read(staging, gpu::Usage::transfer_source)
        .write(texels, gpu::Usage::transfer_destination)
        .execute(
            [this, chunk, &target](gpu::PassContext& context) { return copy_chunk(context, chunk, target, true); });
    return {};
}

Status ShadowMaps::draw_chunk(gpu::PassContext& context, const scene::GpuScene& scene, const Chunk& chunk,
                              bool load) const {
    const VkRenderingAttachmentInfo depth =
        gpu::rendering_attachment(staging_.view(), VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL, load);
    VkRenderingInfo rendering{VK_STRUCTURE_TYPE_RENDERING_INFO};
    rendering.renderArea.extent = {resolution_, resolution_};
    rendering.layerCount = std::uint32_t(chunk.slots.size());
    rendering.pDepthAttachment = &depth;
    const gpu::DeviceFunctions& vk = context.device.vk;
    gpu::begin_rendering(vk, context.commands, rendering, resolution_, resolution_);
    Status status;
    if (chunk.command_count > 0 || !chunk.hole_textures.empty()) {
        const VkBuffer buffers[] = {scene.positions().handle(), chunk.jobs.buffer};
        const VkDeviceSize offsets[] = {0, chunk.jobs.offset};
        vk.vkCmdBindVertexBuffers(context.commands, 0, 2, buffers, offsets);
        vk.vkCmdBindIndexBuffer(context.commands, scene.indices().handle(), 0, VK_INDEX_TYPE_UINT32);
        for (const bool culled : {false, true}) {
            const std::uint32_t plain = chunk.command_count - chunk.culled_count;
            const std::uint32_t count = culled ? chunk.culled_count : plain;
            if (count == 0 || !status)
                continue;
            const gpu::Pipeline& pipeline = bits_ == 16 ? *pipelines16_[culled] : *pipelines32_[culled];
            status = context.resources.bind(context.commands, pipeline, {});
            const VkDeviceSize first = culled ? plain * sizeof(VkDrawIndexedIndirectCommand) : 0;
            if (status)
                vk.vkCmdDrawIndexedIndirect(context.commands, chunk.commands.buffer, chunk.commands.offset + first,
                                            count, sizeof(VkDrawIndexedIndirectCommand));
        }
        if (status)
            status = draw_holes(context, scene, chunk);
    }
    vk.vkCmdEndRendering(context.commands);
    return status;
}

// Each surface with its texture bound.
Status ShadowMaps::draw_holes(gpu::PassContext& context, const scene::GpuScene& scene, const Chunk& chunk) const {
    if (chunk.hole_textures.empty())
        return {};
    const gpu::DeviceFunctions& vk = context.device.vk;
    const gpu::Pipeline& pipeline = *hole_pipelines_[bits_ == 16 ? 0 : 1];
    const VkBuffer buffers[] = {scene.texture_coordinates().handle(), scene.colours().handle()};
    const VkDeviceSize offsets[2] = {};
    vk.vkCmdBindVertexBuffers(context.commands, jobs_buffer + 1, 2, buffers, offsets);
    for (std::uint32_t i = 0; i < chunk.hole_textures.size(); ++i) {
        const gpu::Binding bindings[] = {gpu::Binding::storage(scene.rows()), gpu::Binding::storage(scene.materials()),
                                         scene.textures().binding(chunk.hole_textures[i])};
        SUNFLECK_TRY(context.resources.bind(context.commands, pipeline, bindings));
        vk.vkCmdDrawIndexedIndirect(context.commands, chunk.commands.buffer,
                                    chunk.commands.offset +
                                        (chunk.command_count + i) * sizeof(VkDrawIndexedIndirectCommand),
                                    1, sizeof(VkDrawIndexedIndirectCommand));
    }
    return {};
}

Status ShadowMaps::copy_chunk(gpu::PassContext& context, const Chunk& chunk, const gpu::Buffer& buffer,
                              bool to_buffer) const {
    const VkDeviceSize bytes_per_map = VkDeviceSize(resolution_) * resolution_ * bits_ / 8;
    std::vector<VkBufferImageCopy> regions;
    for (std::uint32_t layer = 0; layer < chunk.slots.size(); ++layer)
        for (const MapArea& area : chunk.areas[layer].areas()) {
            VkBufferImageCopy region{};
            region.bufferOffset =
                bytes_per_map * chunk.slots[layer] + (VkDeviceSize(area.low.y) * resolution_ + area.low.x) * bits_ / 8;
            region.bufferRowLength = resolution_;
            region.bufferImageHeight = resolution_;
            region.imageSubresource = {VK_IMAGE_ASPECT_DEPTH_BIT, 0, layer, 1};
            region.imageOffset = {std::int32_t(area.low.x), std::int32_t(area.low.y), 0};
            region.imageExtent = {area.high.x - area.low.x, area.high.y - area.low.y, 1};
            regions.push_back(region);
        }
    const std::uint32_t count = std::uint32_t(regions.size());
    if (count == 0)
        return {};
    if (to_buffer)
        context.device.vk.vkCmdCopyImageToBuffer(context.commands, staging_.handle(),
                                                 VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, buffer.handle(), count,
                                                 regions.data());
    else
        context.device.vk.vkCmdCopyBufferToImage(context.commands, buffer.handle(), staging_.handle(),
                                                 VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, count, regions.data());
    return {};
}

} // namespace sunfleck::gi

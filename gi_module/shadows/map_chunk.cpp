#include "gi_module/shadows/map_chunk.h"

#include "engine/core/divide_up.h"
#include "engine/core/jobs.h"
#include "gi_module/shadows/shadow_jobs.h"

#include <algorithm>

namespace sunfleck::gi {

// Jobs by level of detail: one command draws all maps that show the item at one level. The finest is the mesh itself,
// with coincident vertices joined.
void ShadowMaps::add_item(const scene::DrawItem& item, std::span<const ShadowRequest> requests, Occluders occluders,
                          bool detail, ChunkPart& part) const {
    const bool has_holes = item.kind == scene::surface_kind_holes;
    std::vector<std::vector<shared::ShadowJob>> by_level((detail && !has_holes ? item.details.size() : 1) * 2);
    for (std::uint32_t layer = 0; layer < requests.size(); ++layer) {
        if (requests[layer].hides(item.entity))
            continue;
        const MapPart covered = part_covered(requests[layer], item.bounds, occluders == Occluders::movers);
        part.seen[layer] |= covered.faces;
        if (occluders == Occluders::movers)
            part.areas.emplace_back(layer, covered.area);
        std::size_t level = 0;
        if (!has_holes)
            level = (detail ? detail_level(requests[layer], item) * 2 : 0) +
                    (shows_front_faces_only(requests[layer], item) ? 1 : 0);
        for (std::uint32_t face = 0; covered.faces >> face; ++face)
            if ((covered.faces >> face) & 1u)
                by_level[level].push_back(make_shadow_job(requests[layer].light, requests[layer].light_class,
                                                          {layer, face, resolution_, requests[layer].tile},
                                                          item.constants, item.row));
    }
    for (std::size_t level = 0; level < by_level.size(); ++level) {
        if (by_level[level].empty())
            continue;
        if (has_holes) {
            part.hole_textures.push_back(item.textures[0]);
            part.add({item.index_count, 0, item.first_index, item.vertex_offset, 0}, part.hole_commands,
                     by_level[level], item.vertex_count);
            continue;
        }
        const scene::DetailRange& range = item.details[level / 2];
        part.add({range.index_count, 0, range.first_index, item.vertex_offset, 0},
                 level % 2 ? part.culled_commands : part.commands, by_level[level], range.vertex_count);
    }
}

Result<ShadowMaps::Chunk> ShadowMaps::prepare_chunk(const scene::GpuScene& scene, gpu::FrameResources& resources,
                                                    std::span<const ShadowRequest> requests, Occluders occluders,
                                                    bool detail, ShadowCounters& counters) const {
    constexpr std::size_t items_at_once = 128;
    const std::span<const scene::DrawItem> items = scene.draws();
    std::vector<ChunkPart> parts(divide_up(items.size(), items_at_once));
    parallel_for_chunks(items.size(), items_at_once, [&](std::size_t begin, std::size_t end) {
        ChunkPart& part = parts[begin / items_at_once];
        part.seen.resize(requests.size());
        for (const scene::DrawItem& item : items.subspan(begin, end - begin))
            if (item.casts_shadow &&
                (occluders == Occluders::all || item.is_static == (occluders == Occluders::static_only)))
                add_item(item, requests, occluders, detail, part);
    });
    std::size_t job_count = 0;
    for (const ChunkPart& part : parts)
        job_count += part.jobs.size();
    Chunk chunk;
    SUNFLECK_ASSIGN(chunk.jobs, resources.allocate(job_count * sizeof(shared::ShadowJob)));
    ChunkPart all;
    all.seen.resize(requests.size());
    std::size_t jobs_before = 0;
    for (ChunkPart& part : parts) {
        all.append(part, jobs_before);
        // Many objects have hundreds of megabytes of jobs: they are copied once, and each part ends with that.
        std::copy(part.jobs.begin(), part.jobs.end(),
                  reinterpret_cast<shared::ShadowJob*>(chunk.jobs.data) + jobs_before);
        jobs_before += part.jobs.size();
        part = {};
    }
    for (const ShadowRequest& request : requests)
        chunk.slots.push_back(request.slot);
    chunk.areas.resize(requests.size());
    for (const auto& [layer, area] : all.areas)
        chunk.areas[layer].add(area);
    chunk.hole_textures = std::move(all.hole_textures);
    for (const std::uint32_t faces : all.seen)
        counters.faces += std::uint64_t(std::popcount(faces));
    counters.vertices += all.vertices;
    counters.draws += (all.commands.empty() ? 0 : 1) + all.hole_commands.size();
    chunk.command_count = std::uint32_t(all.commands.size() + all.culled_commands.size());
    chunk.culled_count = std::uint32_t(all.culled_commands.size());
    all.commands.insert(all.commands.end(), all.culled_commands.begin(), all.culled_commands.end());
    all.commands.insert(all.commands.end(), all.hole_commands.begin(), all.hole_commands.end());
    SUNFLECK_ASSIGN(chunk.commands, resources.upload(std::span<const VkDrawIndexedIndirectCommand>(all.commands)));
    return chunk;
}

// The coarsest level whose surface is not off by more than the request allows where the object is nearest to the light.
std::size_t ShadowMaps::detail_level(const ShadowRequest& request, const scene::DrawItem& item) const {
    float texel;
    if (request.light_class == shared::light_class_directional) {
        texel = 2.0f / (request.light.tangent_scale.w * float(resolution_) * request.tile.scale);
    } else {
        const float radius = 0.5f * glm::length(item.bounds.extent());
        const float distance = glm::length(item.bounds.centre() - vec3(request.light.position_bound)) - radius;
        texel = 2.0f / (float(resolution_) * request.tile.scale) * std::max(distance, 0.0f);
        if (request.has_cone_map())
            texel /= std::max(request.light.position_bound.w, 1.0f);
    }
    std::size_t level = 0;
    while (level + 1 < item.details.size() &&
           item.details[level + 1].error * item.scale < request.detail_texels * texel)
        ++level;
    return level;
}

// A light outside a closed mesh sees its front faces, and they hide all others.
bool ShadowMaps::shows_front_faces_only(const ShadowRequest& request, const scene::DrawItem& item) {
    const vec3 position(request.light.position_bound);
    const bool inside = glm::all(glm::greaterThanEqual(position, item.bounds.minimum)) &&
                        glm::all(glm::lessThanEqual(position, item.bounds.maximum));
    return item.closed && !inside && request.light_class == shared::light_class_surface;
}

} // namespace sunfleck::gi

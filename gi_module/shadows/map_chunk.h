// What is drawn together: as many shadow maps as the staging image has layers, and the items that cast shadows in them.
#pragma once

#include "gi_module/shadows/shadow_maps.h"

namespace sunfleck::gi {

// Everything that one pair of passes (draw, copy) needs; lives in the passes' closures.
struct ShadowMaps::Chunk {
    gpu::UploadSlice jobs, commands;
    std::uint32_t command_count = 0;
    std::uint32_t culled_count = 0; // of the commands, those after the plain ones draw faces towards the light only
    // The last commands draw surfaces with holes, each with its texture.
    std::vector<std::int32_t> hole_textures;
    std::vector<std::uint32_t> slots; // by layer
    std::vector<MapAreas> areas;      // that occluders cover, by layer; then, that is copied
};

// What some items add to a chunk. Commands count jobs from the part's first.
struct ShadowMaps::ChunkPart {
    std::vector<shared::ShadowJob> jobs;
    std::vector<VkDrawIndexedIndirectCommand> commands, culled_commands, hole_commands;
    std::vector<std::int32_t> hole_textures;
    std::vector<std::uint32_t> seen;                      // faces, by layer
    std::vector<std::pair<std::uint32_t, MapArea>> areas; // of layers, that movers cover
    std::uint64_t vertices = 0;

    void add(const VkDrawIndexedIndirectCommand& command, std::vector<VkDrawIndexedIndirectCommand>& list,
             std::span<const shared::ShadowJob> of_command, std::uint32_t vertex_count) {
        list.push_back(command);
        list.back().instanceCount = std::uint32_t(of_command.size());
        list.back().firstInstance = std::uint32_t(jobs.size());
        jobs.insert(jobs.end(), of_command.begin(), of_command.end());
        vertices += std::uint64_t(of_command.size()) * vertex_count;
    }
    // Commands of a part whose jobs come after so many others.
    static void move(std::vector<VkDrawIndexedIndirectCommand>& from, std::vector<VkDrawIndexedIndirectCommand>& to,
                     std::size_t jobs_before) {
        for (VkDrawIndexedIndirectCommand& command : from)
            command.firstInstance += std::uint32_t(jobs_before);
        to.insert(to.end(), from.begin(), from.end());
    }
    // All but the jobs, of which so many come before the part's.
    void append(ChunkPart& part, std::size_t jobs_before) {
        move(part.commands, commands, jobs_before);
        move(part.culled_commands, culled_commands, jobs_before);
        move(part.hole_commands, hole_commands, jobs_before);
        hole_textures.insert(hole_textures.end(), part.hole_textures.begin(), part.hole_textures.end());
        for (std::size_t layer = 0; layer < part.seen.size(); ++layer)
            seen[layer] |= part.seen[layer];
        areas.insert(areas.end(), part.areas.begin(), part.areas.end());
        vertices += part.vertices;
    }
};

} // namespace sunfleck::gi

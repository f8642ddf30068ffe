// glTF 2.0: geometry, materials, cameras, punctual lights and the node hierarchy, both ways.
#pragma once

#include "engine/core/result.h"
#include "engine/scene/components.h"
#include "engine/scene/mesh_store.h"

#include <filesystem>
#include <string>
#include <vector>

namespace sunfleck::io {

// glTF's photometric units (candela, lux, nit) over ours, lm/W. Used both ways, here alone.
inline constexpr float luminous_efficacy = 683.0f;

struct ImportReport {
    std::vector<std::string> notes; // what the file has and this import leaves out
};

// Adds the file's default scene to `registry`. Files outside the glTF file's folder are not read; every accessor and
// index is checked. On failure nothing has been added.
Result<ImportReport> import_gltf(const std::filesystem::path& path, ecs::Registry& registry, scene::MeshStore& meshes);

// Writes entities with a Name as nodes of a .glb file. What glTF has no words for (AreaLight, Mover, Exposure,
// Environment) is left to the scene file.
Status export_gltf(const std::filesystem::path& path, ecs::Registry& registry, const scene::MeshStore& meshes);

} // namespace sunfleck::io

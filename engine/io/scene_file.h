// Scene files (.scene.json): a glTF file plus what glTF has no words for, by node name.
//
//     { "sunfleck_scene": 1, "gltf": "room.glb",
//       "entities": { "lamp": { "AreaLight": { "shape": "rectangle", "width": 1, ... } } } }
#pragma once

#include "engine/io/gltf.h"

namespace sunfleck::io {

// Loads a .gltf, .glb or .scene.json file into an empty registry and brings world transforms up to date.
Result<ImportReport> load_scene(const std::filesystem::path& path, ecs::Registry& registry, scene::MeshStore& meshes);

// Writes `path` (.scene.json) and, beside it, the .glb file of the same name. Names of entities must differ.
Status save_scene(const std::filesystem::path& path, ecs::Registry& registry, const scene::MeshStore& meshes);

} // namespace sunfleck::io

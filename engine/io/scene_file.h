// Scene files (.scene.json): a glTF file plus what glTF cannot express, by node name. Versioned, with a checksum
// against damage. docs/scene.schema.json describes them.
//
//     { "sunfleck_scene": 2, "gltf": "room.glb",
//       "entities": { "lamp": { "AreaLight": { "shape": "rectangle", "width": 1, ... } } },
//       "settings": { "lights": 600 } }
#pragma once

#include "engine/io/file_access.h"
#include "engine/io/gltf.h"
#include "engine/scene/environment_map.h"

namespace sunfleck::io {

// Loads a .gltf, .glb or .scene.json file into an empty registry and brings world transforms and deformed meshes up to
// date. A scene file reaches what lies under its folder once links are resolved, by any spelling; more only with
// ImportOptions::allow_outside. On failure nothing is added.
Result<ImportReport> load_scene(const std::filesystem::path& path, ecs::Registry& registry, scene::MeshStore& meshes,
                                scene::TextureStore& textures, const ImportOptions& options = {});

struct SaveOptions {
    // A glTF file (relative to the scene file, under its folder) that holds the geometry and stays unchanged;
    // transforms, materials, cameras and lights, which may differ from it, go into the scene file. Empty: a .glb file
    // is written.
    std::string gltf_reference;
    std::map<std::string, std::string> settings; // lighting settings by name
    // Also what glTF cannot say: that an entity has no place, geometry no material, a material no geometry, several
    // lights of one entity, and that there are no lights at all, so that none are added.
    bool exact = false;
    EncodedTextures* encoded = nullptr; // of this store, from earlier saves
    // A JSON object on the file that the scene was made from, for editors: ImportReport::source of the scene that is
    // read again. Empty: none.
    std::string source;
};

// Writes `path` (.scene.json) and, without a reference, a .glb file of the same name (or with `.2`, so that the files
// of the last save stay valid until the new ones are complete). Names of entities must be unique. At any moment, even
// if the process is killed or the disk is full, either the old or the new scene can be loaded. Pictures of the sky that
// were loaded for saving (ImportOptions::for_saving) are copied beside it.
Status save_scene(const std::filesystem::path& path, ecs::Registry& registry, const scene::MeshStore& meshes,
                  const scene::TextureStore& textures, const SaveOptions& options = {});

// Scene-linear for EXR and HDR; PNG and JPEG are assumed to be sRGB and linearised.
Result<std::shared_ptr<const scene::EnvironmentImage>> load_environment_image(const std::filesystem::path& path,
                                                                              const FileAccess& access = {{}, true},
                                                                              bool for_saving = false);

// JSON schema of scene files, from the descriptions of components.
std::string scene_file_schema();

} // namespace sunfleck::io

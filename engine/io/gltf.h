// glTF 2.0 both ways: geometry, materials and textures, cameras, punctual lights, the node hierarchy, skins, morph
// targets and node animations. Imported files are not trusted: whatever is invalid gives one message.
#pragma once

#include "engine/core/result.h"
#include "engine/scene/components.h"
#include "engine/scene/mesh_store.h"
#include "engine/scene/texture_store.h"

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace sunfleck::io {

class EncodedTextures;

// glTF's photometric units (candela, lux, nit) over ours, lm/W. Used both ways, here alone.
inline constexpr float luminous_efficacy = 683.0f;

// Radiance, W/(sr m2), of emission 1 without KHR_materials_emissive_strength. By the specification it would be one
// nit, invisible next to a lamp; authors mean a visible glow.
inline constexpr float emission_without_unit = 0.5f;

struct ImportOptions {
    int scene = -1;      // -1: the file's default, else its first, else all nodes without a parent
    std::string variant; // of KHR_materials_variants, by name; empty: the file's own materials
    int animation = 0;   // which one is played; -1: none
    // Also keeps what only a file has that the scene is saved to: the animations that are not played, and the bytes of
    // its pictures of the sky.
    bool for_saving = false;
    // What other files the file names must lie under this folder, once all links are resolved; empty: the file's own.
    std::filesystem::path root;
    bool allow_outside = false;            // they may lie anywhere: for files that the user trusts
    std::uint64_t* content_hash = nullptr; // where not null, continued with the bytes of every file that is read
    // Called occasionally with the fraction done, from any thread but never concurrently; returning false cancels the
    // import with an error.
    std::function<bool(float)> progress;
};

struct ImportReport {
    std::vector<std::string> notes;              // what the import ignored or changed
    std::vector<std::string> scenes, animations; // names, by index
    std::vector<std::string> variants;
    std::map<std::string, std::uint64_t> counts;       // "nodes", "meshes", "triangles", "materials", "textures", ...
    std::map<std::string, std::uint64_t> memory_bytes; // "vertices", "indices", "textures"
    std::map<std::string, std::string> settings;       // lighting settings of a scene file
    std::string source;                                // SaveOptions::source of a scene file
    // Whether the scene may be given a light if it has none; scene files say no where it is meant so.
    bool default_light = true;
};

// Adds a scene of the file to `registry`. Names of entities are made unique by appending a number. What
// other files may be read: ImportOptions::root. On failure nothing is added.
Result<ImportReport> import_gltf(const std::filesystem::path& path, ecs::Registry& registry, scene::MeshStore& meshes,
                                 scene::TextureStore& textures, const ImportOptions& options = {});
// The same from memory, without any other files.
Result<ImportReport> import_gltf_bytes(std::string bytes, ecs::Registry& registry, scene::MeshStore& meshes,
                                       scene::TextureStore& textures, const ImportOptions& options = {});

// Writes entities with a Name as nodes of a .glb file, with skins, morph targets and animations; deforming meshes in
// their rest pose. What glTF cannot express (AreaLight, Mover, Exposure, Environment) is left to the scene file. In
// `extras` nodes say that a skinned mesh is their own and no part of them, or stand for a joint that was deleted.
// `encoded`: of this store, from earlier exports.
Result<std::string> gltf_bytes(ecs::Registry& registry, const scene::MeshStore& meshes,
                               const scene::TextureStore& textures, EncodedTextures* encoded = nullptr);
// The same as a file.
Status export_gltf(const std::filesystem::path& path, ecs::Registry& registry, const scene::MeshStore& meshes,
                   const scene::TextureStore& textures);

} // namespace sunfleck::io

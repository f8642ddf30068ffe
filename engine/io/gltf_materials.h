// Images, samplers and materials of glTF (glTF 2.0, sec. 3.8 and 3.9) as textures and components.
#pragma once

#include "engine/io/gltf_document.h"
#include "engine/scene/components.h"
#include "engine/scene/texture_store.h"

#include <functional>

namespace sunfleck::io {

struct ImportedMaterial {
    scene::Material material;
    scene::MaterialTextures textures;
    bool has_textures = false;
};

// Decoded textures and materials, by their index in the file.
class MaterialImport {
public:
    // Decodes the images that materials use, on all cores. `progress` is called occasionally with the fraction done,
    // from any thread but never concurrently, and returns false to cancel.
    static Result<MaterialImport> read(const GltfDocument& document, const std::function<bool(float)>& progress);

    // -1: glTF's default material.
    const ImportedMaterial& material(int index) const;
    // Moves the textures to the store; materials then refer to the store's textures.
    void add_textures(scene::TextureStore& store);

    std::vector<std::string> notes;

private:
    std::vector<scene::Texture> textures_;
    std::vector<ImportedMaterial> materials_;
    ImportedMaterial fallback_;
};

} // namespace sunfleck::io

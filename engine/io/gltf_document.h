// The outer shell of a glTF file: bytes to a tinygltf model whose references all exist. tinygltf is not safe on its
// own, so what it sees is checked before (nesting, types of sections, references between them), the files it may open
// are limited to the glTF file's folder, and images stay encoded.
#pragma once

#include "engine/io/gltf_accessor.h"

#include <filesystem>

namespace sunfleck::io {

struct GltfDocument {
    tinygltf::Model model;
    // Encoded bytes of each image, by its number, wherever they were.
    std::vector<std::string> images;
};

Result<GltfDocument> read_gltf_document(const std::filesystem::path& path);
// From memory; `folder` is where other files may lie (empty: nowhere).
Result<GltfDocument> parse_gltf_document(std::string bytes, const std::filesystem::path& folder);

} // namespace sunfleck::io

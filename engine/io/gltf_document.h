// Parses a glTF container into a tinygltf model whose references all exist. tinygltf is not safe with untrusted files,
// so its input is checked first (nesting, types of sections, references between them), it may only open files in the
// glTF file's folder, and images stay encoded.
#pragma once

#include "engine/io/gltf_accessor.h"
#include "engine/io/gltf_references.h"

#include <filesystem>

namespace sunfleck::io {

struct GltfDocument {
    tinygltf::Model model;
    // Encoded bytes of each image, by index, wherever they were stored.
    std::vector<std::string> images;
    GltfUsage usage;
    std::vector<std::string> notes; // what is broken, and left out because nothing uses it
};

Result<GltfDocument> read_gltf_document(const std::filesystem::path& path);
// From memory; other files may be read from `folder` (empty: none).
Result<GltfDocument> parse_gltf_document(std::string bytes, const std::filesystem::path& folder);

} // namespace sunfleck::io

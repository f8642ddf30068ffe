// Parses a glTF container into a tinygltf model whose references all exist. tinygltf is not safe with untrusted files,
// so its input is checked first (nesting, types of sections, references between them), it may only open files in the
// glTF file's folder, and images stay encoded.
#pragma once

#include "engine/io/file_access.h"
#include "engine/io/gltf_accessor.h"
#include "engine/io/gltf_references.h"

namespace sunfleck::io {

struct GltfDocument {
    tinygltf::Model model;
    // Encoded bytes of each image, by index, wherever they were stored.
    std::vector<std::string> images;
    GltfUsage usage;
    std::vector<std::string> notes; // what is broken, and left out because nothing uses it
};

// From memory; other files, relative to `folder`, as far as `access` allows (an empty folder: none).
Result<GltfDocument> parse_gltf_document(std::string bytes, const std::filesystem::path& folder,
                                         const FileAccess& access);

} // namespace sunfleck::io

// Draco's compressed meshes, by libdraco. A library of its own: Debian's libdraco exports another version of tinygltf,
// whose functions would take the place of the real ones in any program that links both in the wrong order. Behind this
// library it comes last.
#pragma once

#include "engine/core/result.h"

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace sunfleck::io {

struct DracoMesh {
    struct Attribute {
        std::vector<float> values;
        std::size_t width = 1; // numbers a vertex
    };
    std::map<std::string, Attribute> attributes; // by the names asked for
    std::vector<std::uint32_t> indices;          // three a triangle
};

// `attributes`: names, and the ids under which the data holds them. Everything is finite and in range.
Result<DracoMesh> decode_draco(std::span<const unsigned char> bytes, const std::map<std::string, int>& attributes);

} // namespace sunfleck::io

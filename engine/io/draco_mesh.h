// Draco-compressed meshes, by libdraco. A shared library of its own: Debian's libdraco also exports an old version of
// tinygltf, which would replace the real one in any program that links both in the wrong order. Behind this library it
// comes last in the symbol search.
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
        std::size_t width = 1; // components per vertex
    };
    std::map<std::string, Attribute> attributes; // by requested name
    std::vector<std::uint32_t> indices;          // three per triangle
};

// Asked with the size of the result, in bytes, before memory for it is taken: the limit is the program's.
using AllowDracoMemory = Status (*)(std::uint64_t bytes);

// `attributes`: requested names and their ids in the data. All results are finite and in range.
Result<DracoMesh> decode_draco(std::span<const unsigned char> bytes, const std::map<std::string, int>& attributes,
                               AllowDracoMemory allow);

} // namespace sunfleck::io

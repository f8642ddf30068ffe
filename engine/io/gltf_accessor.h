// Reads glTF accessors (glTF 2.0, sec. 3.6.2) without trusting any number in them.
#pragma once

#include "engine/core/result.h"

#define TINYGLTF_NO_INCLUDE_STB_IMAGE
#define TINYGLTF_NO_INCLUDE_STB_IMAGE_WRITE
#include <tiny_gltf.h>

#include <span>

namespace sunfleck::io {

inline constexpr std::size_t element_limit = 50u << 20; // per accessor
// What an error names that says what a level would take of memory (engine/core/memory_limit.h).
inline constexpr const char* level_detail = "the level's detail";

template <typename T>
bool in_range(int index, const std::vector<T>& list) {
    return index >= 0 && std::size_t(index) < list.size();
}

// What an accessor may contain in a given use.
struct AccessorUse {
    std::vector<int> types;      // TINYGLTF_TYPE_...
    std::vector<int> components; // TINYGLTF_COMPONENT_TYPE_...
    // Integers of KHR_mesh_quantization need not be `normalized`: they are used as they are.
    bool plain_integers = false;
};

// Elements as floats, `width` per element. Normalised integers are converted to [-1, 1] or [0, 1] (sec. 3.11). All
// values are finite.
struct FloatElements {
    std::vector<float> values;
    std::size_t width = 1;
    std::size_t count() const { return values.size() / width; }
    const float* operator[](std::size_t i) const { return &values[i * width]; }
};

// Accepts interleaved, sparse and empty (all zero) accessors. Errors name the accessor and the fault.
Result<FloatElements> read_floats(const tinygltf::Model& model, int accessor, const AccessorUse& use);

// Unsigned integers: indices, joints.
Result<std::vector<std::uint32_t>> read_integers(const tinygltf::Model& model, int accessor, int type,
                                                 const std::vector<int>& components);

// The bytes of a buffer view, checked against its buffer.
Result<std::span<const unsigned char>> view_bytes(const tinygltf::Model& model, int buffer_view);

} // namespace sunfleck::io

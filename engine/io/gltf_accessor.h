// Reading glTF accessors without trusting a number in them: glTF 2.0, sec. 3.6.2.
#pragma once

#include "engine/core/result.h"

#define TINYGLTF_NO_INCLUDE_STB_IMAGE
#define TINYGLTF_NO_INCLUDE_STB_IMAGE_WRITE
#include <tiny_gltf.h>

#include <span>

namespace sunfleck::io {

inline constexpr std::size_t element_limit = 50u << 20; // of one accessor

template <typename T>
bool in_range(int index, const std::vector<T>& list) {
    return index >= 0 && std::size_t(index) < list.size();
}

// What a use of an accessor admits.
struct AccessorUse {
    std::vector<int> types;      // TINYGLTF_TYPE_...
    std::vector<int> components; // TINYGLTF_COMPONENT_TYPE_...
    // Whole numbers of KHR_mesh_quantization need no `normalized`: they stand for themselves.
    bool plain_integers = false;
};

// Elements as floats, component after component; `width` of them an element. Normalised integers become numbers from -1
// or 0 to 1 (sec. 3.11 there). Everything is finite.
struct FloatElements {
    std::vector<float> values;
    std::size_t width = 1;
    std::size_t count() const { return values.size() / width; }
    const float* operator[](std::size_t i) const { return &values[i * width]; }
};

// Interleaved, sparse and empty (all zero) accessors alike. Errors name the accessor and what is wrong with it.
Result<FloatElements> read_floats(const tinygltf::Model& model, int accessor, const AccessorUse& use);

// Unsigned whole numbers: indices, joints.
Result<std::vector<std::uint32_t>> read_integers(const tinygltf::Model& model, int accessor, int type,
                                                 const std::vector<int>& components);

// The bytes of a buffer view, checked against its buffer.
Result<std::span<const unsigned char>> view_bytes(const tinygltf::Model& model, int buffer_view);

} // namespace sunfleck::io

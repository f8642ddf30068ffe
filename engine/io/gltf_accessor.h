// Reading glTF accessors without trusting a number in them.
#pragma once

#include "engine/core/result.h"

#define TINYGLTF_NO_INCLUDE_STB_IMAGE
#define TINYGLTF_NO_INCLUDE_STB_IMAGE_WRITE
#include <tiny_gltf.h>

#include <algorithm>

namespace sunfleck::io {

inline constexpr std::size_t vertex_limit = 50u << 20;

template <typename T>
bool in_range(int index, const std::vector<T>& list) {
    return index >= 0 && std::size_t(index) < list.size();
}

// Calls read(element, address of its first component, component type) after checking that all elements lie in their
// buffer.
template <typename Read>
Status each_element(const tinygltf::Model& model, int accessor_index, int type, const std::vector<int>& component_types,
                    Read&& read) {
    if (!in_range(accessor_index, model.accessors))
        return Error{"an accessor does not exist"};
    const tinygltf::Accessor& accessor = model.accessors[std::size_t(accessor_index)];
    if (accessor.sparse.isSparse || !in_range(accessor.bufferView, model.bufferViews))
        return Error{"sparse accessors and accessors without data are not supported"};
    if (accessor.type != type ||
        std::find(component_types.begin(), component_types.end(), accessor.componentType) == component_types.end())
        return Error{"an accessor has the wrong type"};
    const tinygltf::BufferView& view = model.bufferViews[std::size_t(accessor.bufferView)];
    if (!in_range(view.buffer, model.buffers))
        return Error{"a buffer does not exist"};
    const std::vector<unsigned char>& data = model.buffers[std::size_t(view.buffer)].data;
    const int component = tinygltf::GetComponentSizeInBytes(std::uint32_t(accessor.componentType));
    const int components = tinygltf::GetNumComponentsInType(std::uint32_t(type));
    const int stride = accessor.ByteStride(view);
    if (component <= 0 || components <= 0 || stride < component * components)
        return Error{"an accessor has an invalid stride"};
    const std::size_t element = std::size_t(component) * std::size_t(components);
    if (accessor.count > vertex_limit || view.byteOffset > data.size() ||
        view.byteLength > data.size() - view.byteOffset || accessor.byteOffset > view.byteLength ||
        (accessor.count > 0 &&
         (accessor.count - 1) * std::size_t(stride) + element > view.byteLength - accessor.byteOffset))
        return Error{"an accessor reaches outside its buffer"};
    const unsigned char* first = data.data() + view.byteOffset + accessor.byteOffset;
    for (std::size_t i = 0; i < accessor.count; ++i)
        read(i, first + i * std::size_t(stride), accessor.componentType);
    return {};
}

} // namespace sunfleck::io

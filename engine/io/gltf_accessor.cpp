#include "engine/io/gltf_accessor.h"

#include "engine/core/memory_limit.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace sunfleck::io {
namespace {

Error accessor_error(int accessor, const std::string& why) {
    return Error{"accessor " + std::to_string(accessor) + " " + why};
}

// Whether `count` elements of `element` bytes, `stride` apart, fit into `bytes` from `offset` on. Overflow-safe.
bool fits(std::size_t bytes, std::size_t offset, std::size_t count, std::size_t element, std::size_t stride) {
    if (count == 0)
        return offset <= bytes;
    if (offset > bytes || element > bytes - offset)
        return false;
    return stride == 0 || (count - 1) <= (bytes - offset - element) / stride;
}

// glTF 2.0, sec. 3.11: normalised integers represent -1 to 1, or 0 to 1.
float component_value(const unsigned char* address, int type, bool normalized) {
    const auto scaled = [&](float value, float most) { return normalized ? std::max(value / most, -1.0f) : value; };
    switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
        return scaled(float(static_cast<std::int8_t>(address[0])), 127.0f);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return scaled(float(address[0]), 255.0f);
    case TINYGLTF_COMPONENT_TYPE_SHORT: {
        std::int16_t value;
        std::memcpy(&value, address, sizeof value);
        return scaled(float(value), 32767.0f);
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: {
        std::uint16_t value;
        std::memcpy(&value, address, sizeof value);
        return scaled(float(value), 65535.0f);
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT: {
        std::uint32_t value;
        std::memcpy(&value, address, sizeof value);
        return float(value);
    }
    default: {
        float value;
        std::memcpy(&value, address, sizeof value);
        return value;
    }
    }
}

std::uint32_t integer_value(const unsigned char* address, int type) {
    std::uint32_t value = 0;
    std::memcpy(&value, address, std::size_t(tinygltf::GetComponentSizeInBytes(std::uint32_t(type))));
    return value;
}

bool contains(const std::vector<int>& list, int value) {
    return std::find(list.begin(), list.end(), value) != list.end();
}

// Layout of an element's components: columns of small matrices start at multiples of four bytes.
std::vector<std::size_t> component_offsets(int type, std::size_t component) {
    std::size_t rows = std::size_t(tinygltf::GetNumComponentsInType(std::uint32_t(type))), columns = 1;
    if (type == TINYGLTF_TYPE_MAT2 || type == TINYGLTF_TYPE_MAT3 || type == TINYGLTF_TYPE_MAT4) {
        columns = type == TINYGLTF_TYPE_MAT2 ? 2 : type == TINYGLTF_TYPE_MAT3 ? 3 : 4;
        rows = columns;
    }
    const std::size_t column_bytes = columns > 1 ? (rows * component + 3) / 4 * 4 : rows * component;
    std::vector<std::size_t> offsets;
    for (std::size_t c = 0; c < columns; ++c)
        for (std::size_t r = 0; r < rows; ++r)
            offsets.push_back(c * column_bytes + r * component);
    return offsets;
}

// A run of elements in a buffer view.
struct Elements {
    int view;
    std::size_t offset, count;
    std::size_t component, size; // bytes of a component and of an element
    bool strided;                // elements lie the view's stride apart
};

// Calls read(element, address) for the elements; `accessor` is for messages.
template <typename Read>
Status each_in_view(const tinygltf::Model& model, int accessor, const Elements& elements, const Read& read) {
    SUNFLECK_ASSIGN(const std::span<const unsigned char> bytes, view_bytes(model, elements.view));
    const tinygltf::BufferView& source = model.bufferViews[std::size_t(elements.view)];
    const bool strided = elements.strided && source.byteStride > 0;
    const std::size_t stride = strided ? source.byteStride : elements.size, component = elements.component;
    if (stride < elements.size || (strided && source.byteStride % component != 0))
        return accessor_error(accessor, "has an invalid stride of " + std::to_string(stride) + " bytes");
    if ((source.byteOffset + elements.offset) % component != 0)
        return accessor_error(accessor, "is not aligned to its components of " + std::to_string(component) + " bytes");
    if (!fits(bytes.size(), elements.offset, elements.count, elements.size, stride))
        return accessor_error(accessor, "reaches outside its buffer view");
    for (std::size_t i = 0; i < elements.count; ++i)
        read(i, bytes.data() + elements.offset + i * stride);
    return {};
}

// The elements that sparse storage replaces, in ascending order.
Result<std::vector<std::size_t>> sparse_indices(const tinygltf::Model& model, int index) {
    const tinygltf::Accessor& accessor = model.accessors[std::size_t(index)];
    const auto& sparse = accessor.sparse;
    const int type = sparse.indices.componentType;
    if (!contains({TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE, TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT,
                   TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT},
                  type) ||
        sparse.count < 1 || std::size_t(sparse.count) > accessor.count || sparse.indices.byteOffset < 0 ||
        sparse.values.byteOffset < 0)
        return accessor_error(index, "has an invalid sparse part");
    const std::size_t size = std::size_t(tinygltf::GetComponentSizeInBytes(std::uint32_t(type)));
    std::vector<std::size_t> places;
    SUNFLECK_TRY(each_in_view(
        model, index,
        {sparse.indices.bufferView, std::size_t(sparse.indices.byteOffset), std::size_t(sparse.count), size, size,
         false},
        [&](std::size_t, const unsigned char* address) { places.push_back(integer_value(address, type)); }));
    for (std::size_t i = 0; i < places.size(); ++i)
        if (places[i] >= accessor.count || (i > 0 && places[i] <= places[i - 1]))
            return accessor_error(index, "has sparse indices that do not increase or point past its end");
    return places;
}

// Calls read(element, address) for all elements, then for those that sparse storage replaces.
template <typename Read>
Status each_element(const tinygltf::Model& model, int index, const Read& read) {
    const tinygltf::Accessor& accessor = model.accessors[std::size_t(index)];
    const std::size_t component = std::size_t(tinygltf::GetComponentSizeInBytes(std::uint32_t(accessor.componentType)));
    const std::size_t size = component_offsets(accessor.type, component).back() + component;
    if (accessor.bufferView >= 0)
        SUNFLECK_TRY(each_in_view(
            model, index, {accessor.bufferView, accessor.byteOffset, accessor.count, component, size, true}, read));
    else if (accessor.byteOffset != 0)
        return accessor_error(index, "has an offset but no buffer view");
    if (!accessor.sparse.isSparse)
        return {};
    SUNFLECK_ASSIGN(const std::vector<std::size_t> places, sparse_indices(model, index));
    const auto& values = accessor.sparse.values;
    return each_in_view(model, index,
                        {values.bufferView, std::size_t(values.byteOffset), places.size(), component, size, false},
                        [&](std::size_t i, const unsigned char* address) { read(places[i], address); });
}

Result<const tinygltf::Accessor*> find_accessor(const tinygltf::Model& model, int index, const std::vector<int>& types,
                                                const std::vector<int>& components) {
    if (!in_range(index, model.accessors))
        return Error{"accessor " + std::to_string(index) + " does not exist"};
    const tinygltf::Accessor& accessor = model.accessors[std::size_t(index)];
    if (!contains(types, accessor.type) || !contains(components, accessor.componentType))
        return accessor_error(index, "has a type that is not allowed here");
    if (accessor.count < 1 || accessor.count > element_limit)
        return accessor_error(index, "has " + std::to_string(accessor.count) + " elements; 1 to " +
                                         std::to_string(element_limit) + " are supported");
    if (accessor.bufferView < 0 && !accessor.sparse.isSparse && accessor.count > (1u << 20))
        return accessor_error(index, "has no data");
    return &accessor;
}

// Before numbers of four bytes are taken for them: an accessor without a buffer view, or with sparse storage alone, is
// of any size in a few bytes of a file.
Status check_elements(int index, std::size_t numbers) {
    return check_memory(numbers * 4, "accessor " + std::to_string(index), level_detail);
}

} // namespace

Result<std::span<const unsigned char>> view_bytes(const tinygltf::Model& model, int index) {
    if (!in_range(index, model.bufferViews))
        return Error{"buffer view " + std::to_string(index) + " does not exist"};
    const tinygltf::BufferView& view = model.bufferViews[std::size_t(index)];
    if (!in_range(view.buffer, model.buffers))
        return Error{"buffer view " + std::to_string(index) + " names a buffer that does not exist"};
    const std::vector<unsigned char>& data = model.buffers[std::size_t(view.buffer)].data;
    if (view.byteOffset > data.size() || view.byteLength > data.size() - view.byteOffset)
        return Error{"buffer view " + std::to_string(index) + " reaches outside its buffer"};
    return std::span<const unsigned char>(data.data() + view.byteOffset, view.byteLength);
}

Result<FloatElements> read_floats(const tinygltf::Model& model, int index, const AccessorUse& use) {
    SUNFLECK_ASSIGN(const tinygltf::Accessor* accessor, find_accessor(model, index, use.types, use.components));
    const int type = accessor->componentType;
    const bool integer = type != TINYGLTF_COMPONENT_TYPE_FLOAT;
    if (integer && !accessor->normalized && !use.plain_integers)
        return accessor_error(index, "holds integers that are not normalized");
    const std::size_t component = std::size_t(tinygltf::GetComponentSizeInBytes(std::uint32_t(type)));
    const std::vector<std::size_t> offsets = component_offsets(accessor->type, component);
    FloatElements result;
    result.width = offsets.size();
    SUNFLECK_TRY(check_elements(index, accessor->count * result.width));
    result.values.assign(accessor->count * result.width, 0.0f);
    SUNFLECK_TRY(each_element(model, index, [&](std::size_t i, const unsigned char* address) {
        for (std::size_t c = 0; c < offsets.size(); ++c)
            result.values[i * result.width + c] = component_value(address + offsets[c], type, accessor->normalized);
    }));
    if (!integer && !std::all_of(result.values.begin(), result.values.end(), [](float v) { return std::isfinite(v); }))
        return accessor_error(index, "holds a number that is not finite");
    return result;
}

Result<std::vector<std::uint32_t>> read_integers(const tinygltf::Model& model, int index, int type,
                                                 const std::vector<int>& components) {
    SUNFLECK_ASSIGN(const tinygltf::Accessor* accessor, find_accessor(model, index, {type}, components));
    const int kind = accessor->componentType;
    const std::size_t component = std::size_t(tinygltf::GetComponentSizeInBytes(std::uint32_t(kind)));
    const std::vector<std::size_t> offsets = component_offsets(type, component);
    SUNFLECK_TRY(check_elements(index, accessor->count * offsets.size()));
    std::vector<std::uint32_t> result(accessor->count * offsets.size(), 0);
    SUNFLECK_TRY(each_element(model, index, [&](std::size_t i, const unsigned char* address) {
        for (std::size_t c = 0; c < offsets.size(); ++c)
            result[i * offsets.size() + c] = integer_value(address + offsets[c], kind);
    }));
    return result;
}

} // namespace sunfleck::io

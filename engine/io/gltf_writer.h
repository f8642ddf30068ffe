// The buffer of a glTF file that is being written, and the views and accessors that point into it. Not for use outside
// this folder.
#pragma once

#define TINYGLTF_NO_INCLUDE_STB_IMAGE
#define TINYGLTF_NO_INCLUDE_STB_IMAGE_WRITE
#include "engine/core/hash.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace sunfleck::io {

// What the files of this program say in `extras`, where glTF has no words for it.
inline constexpr const char *mark_own_mesh = "sunfleck_own_mesh", // the skinned mesh is this node's, and no child's
    *mark_no_entity = "sunfleck_no_entity",                       // a joint that is not there: no entity becomes of it
        *mark_not_played = "sunfleck_not_played",    // an animation that is first in the file, and yet kept only
            *weights_key = "sunfleck_weights_of",    // node that has the weights of this one's mesh
                *duration_key = "sunfleck_duration"; // of a channel: s after which it repeats

inline bool is_marked(const tinygltf::Value& extras, const char* mark) {
    return extras.IsObject() && extras.Has(mark) && extras.Get(mark).IsBool() && extras.Get(mark).Get<bool>();
}

struct GltfWriter {
    tinygltf::Model model;
    std::set<std::string> extensions; // that are used

    GltfWriter() { model.buffers.emplace_back(); }

    int add_view(const void* bytes, std::size_t size, int target) {
        std::vector<unsigned char>& data = model.buffers[0].data;
        data.resize((data.size() + 3) / 4 * 4); // accessors begin at multiples of their components' size
        tinygltf::BufferView view;
        view.buffer = 0;
        view.byteOffset = data.size();
        view.byteLength = size;
        view.target = target;
        const auto* first = static_cast<const unsigned char*>(bytes);
        data.insert(data.end(), first, first + size);
        model.bufferViews.push_back(view);
        return int(model.bufferViews.size() - 1);
    }

    template <typename T>
    int add_accessor(const std::vector<T>& values, int type, int component, int target) {
        tinygltf::Accessor accessor;
        accessor.bufferView = add_view(values.data(), values.size() * sizeof(T), target);
        accessor.componentType = component;
        accessor.type = type;
        accessor.count = values.size();
        model.accessors.push_back(accessor);
        return int(model.accessors.size() - 1);
    }

    // An accessor of times is not to be one of weights, too.
    enum class Use : std::uint64_t { any, times };
    // The same as one that was added here before, if that has the same content.
    template <typename T>
    int share_accessor(const std::vector<T>& values, int type, int component, int target, Use use = Use::any) {
        const std::size_t size = values.size() * sizeof(T);
        std::vector<int>& alike = shared_[{use, hash_bytes(hash_start, values.data(), size)}];
        for (const int number : alike) {
            const tinygltf::Accessor& known = model.accessors[std::size_t(number)];
            const tinygltf::BufferView& view = model.bufferViews[std::size_t(known.bufferView)];
            if (known.type == type && known.componentType == component && view.target == target &&
                view.byteLength == size &&
                std::memcmp(&model.buffers[0].data[view.byteOffset], values.data(), size) == 0)
                return number;
        }
        alike.push_back(add_accessor(values, type, component, target));
        return alike.back();
    }

    // glTF asks for the smallest and the largest values of positions and of times.
    template <typename T>
    void add_bounds(int number, const std::vector<T>& values, int width) {
        tinygltf::Accessor& accessor = model.accessors[std::size_t(number)];
        if (!accessor.minValues.empty() || values.empty())
            return;
        const auto* numbers = reinterpret_cast<const float*>(values.data());
        for (int c = 0; c < width; ++c) {
            float low = numbers[c], high = numbers[c];
            for (std::size_t i = 1; i < values.size(); ++i) {
                const float value = numbers[i * std::size_t(width) + std::size_t(c)];
                low = std::min(low, value), high = std::max(high, value);
            }
            accessor.minValues.push_back(double(low));
            accessor.maxValues.push_back(double(high));
        }
    }

private:
    std::map<std::pair<Use, std::uint64_t>, std::vector<int>> shared_; // by hash of content
};

} // namespace sunfleck::io

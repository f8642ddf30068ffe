// Small glTF files made in memory, for tests of the importer.
#pragma once

#include "engine/core/file.h"
#include "engine/io/scene_file.h"
#include "tests/support/folder.h"

#include <cstring>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

namespace sunfleck::tests {

using nlohmann::json;

// A registry with its stores.
struct World {
    ecs::Registry registry;
    scene::MeshStore meshes;
    scene::TextureStore textures;
    World() { scene::register_components(registry); }

    Result<io::ImportReport> import(const std::string& bytes, const io::ImportOptions& options = {}) {
        auto report = io::import_gltf_bytes(bytes, registry, meshes, textures, options);
        scene::update_world_transforms(registry);
        return report;
    }
    const scene::Mesh& mesh_of(const std::string& name) {
        return meshes[registry.get<scene::MeshInstance>(scene::find_by_name(registry, name)).mesh];
    }
};

// Builds a file piece by piece; `file` is its JSON and `binary` its one buffer.
struct GltfBuilder {
    json file = {{"asset", {{"version", "2.0"}}}, {"scene", 0}, {"scenes", {{{"nodes", {0}}}}}};
    std::string binary;

    int view(const void* data, std::size_t bytes) {
        binary.resize((binary.size() + 3) / 4 * 4);
        file["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", bytes}});
        binary.append(static_cast<const char*>(data), bytes);
        return int(file["bufferViews"].size()) - 1;
    }
    template <typename T>
    int accessor(const std::vector<T>& values, int component, const char* type, std::size_t count) {
        const int data = view(values.data(), values.size() * sizeof(T));
        file["accessors"].push_back(
            {{"bufferView", data}, {"componentType", component}, {"count", count}, {"type", type}});
        return int(file["accessors"].size()) - 1;
    }
    int floats(const std::vector<float>& values, const char* type, std::size_t width) {
        return accessor(values, 5126, type, values.size() / width);
    }
    // A unit square of two triangles in the XY plane, facing +Z, with a node.
    void add_square() {
        const int positions = floats({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, "VEC3", 3);
        const int indices = accessor(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3}, 5123, "SCALAR", 6);
        file["meshes"] = {
            {{"name", "square"}, {"primitives", {{{"attributes", {{"POSITION", positions}}}, {"indices", indices}}}}}};
        file["nodes"] = {{{"name", "square"}, {"mesh", 0}}};
    }
    json& primitive() { return file["meshes"][0]["primitives"][0]; }

    std::string glb() {
        if (!binary.empty())
            file["buffers"][0] = {{"byteLength", binary.size()}};
        std::string text = file.dump(), body = binary;
        text.resize((text.size() + 3) / 4 * 4, ' ');
        body.resize((body.size() + 3) / 4 * 4, '\0');
        const auto word = [](std::size_t value) {
            const std::uint32_t bits = std::uint32_t(value);
            return std::string(reinterpret_cast<const char*>(&bits), 4);
        };
        const std::size_t total = 12 + 8 + text.size() + (body.empty() ? 0 : 8 + body.size());
        std::string bytes = "glTF" + word(2) + word(total) + word(text.size()) + "JSON" + text;
        if (!body.empty())
            bytes += word(body.size()) + std::string("BIN\0", 4) + body;
        return bytes;
    }
};

} // namespace sunfleck::tests

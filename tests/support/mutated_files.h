// Damaged glTF files: samples of all kinds, what may happen to them, and what holds of those that are still read.
#pragma once

#include "engine/core/random.h"
#include "test_places.h"
#include "tests/support/gltf_files.h"

#include <algorithm>

namespace sunfleck::tests {

// Whatever is accepted is sound: what draws and traces it may rely on this.
inline void expect_sound(World& world, const std::string& what) {
    for (std::uint32_t i = 0; i < world.meshes.size(); ++i) {
        const scene::Mesh& mesh = world.meshes[i];
        ASSERT_EQ(mesh.normals.size(), mesh.positions.size()) << what;
        for (const std::uint32_t index : mesh.indices)
            ASSERT_LT(index, mesh.positions.size()) << what;
        for (const vec3 position : mesh.positions)
            ASSERT_TRUE(is_finite(position)) << what;
        for (const std::size_t optional : {mesh.texture_coordinates.size(), mesh.tangents.size(), mesh.colours.size()})
            ASSERT_TRUE(optional == 0 || optional == mesh.positions.size()) << what;
    }
    world.registry.view<scene::Transform>().each([&](ecs::Entity, const scene::Transform& transform) {
        ASSERT_TRUE(is_finite(transform.position) && is_finite(transform.scale)) << what;
    });
    world.registry.view<scene::MaterialTextures>().each([&](ecs::Entity, const scene::MaterialTextures& textures) {
        ASSERT_LT(textures.base_colour.texture, std::int32_t(world.textures.size())) << what;
        ASSERT_LT(textures.normal.texture, std::int32_t(world.textures.size())) << what;
    });
}

// Files of all kinds that the importer reads; large ones are left out, so that many cases fit into the time.
inline std::vector<std::string> sample_files() {
    namespace fs = std::filesystem;
    GltfBuilder square;
    square.add_square();
    std::vector<std::string> result = {square.glb()};
    square.primitive()["targets"] = {{{"POSITION", 0}}, json::object()};
    square.file["nodes"][0]["weights"] = {0.5, 0.25};
    result.push_back(square.glb());
    for (const char* folder : {SUNFLECK_SOURCE_DIR "/tests/corpus", "/usr/share/assimp/models/glTF2"}) {
        std::error_code code;
        std::vector<fs::path> paths;
        for (const auto& entry : fs::recursive_directory_iterator(folder, code))
            if (entry.is_regular_file() && entry.file_size() < 3000000 &&
                (entry.path().extension() == ".glb" || entry.path().extension() == ".gltf") &&
                entry.path().filename() != "numbers.gltf") // odd_numbers_test.cpp has it; seeds name the same files on
                paths.push_back(entry.path());
        std::sort(paths.begin(), paths.end());
        for (const fs::path& path : paths)
            if (const auto bytes = read_file(path); bytes && World().import(*bytes))
                result.push_back(*bytes);
    }
    return result;
}

// Up to three changes: bytes, bits, pieces left out, repeated or cut off, and numbers of the JSON.
inline std::string mutated(std::string bytes, std::uint32_t seed) {
    std::uint32_t counter = 0;
    const auto random = [&](std::size_t limit) {
        return std::size_t(pcg_hash(hash_combine(seed, ++counter))) % std::max<std::size_t>(limit, 1);
    };
    static const std::vector<std::string> words = {"-1",    "0",    "4294967296", "4611686018427387904",
                                                   "1e39",  "-0.0", "[]",         "{}",
                                                   "null",  "true", "\"\"",       "\"../x\"",
                                                   "65535", "5126", "1e400"};
    // Half of the cases keep the file's length: what frames the content stays whole, and more gets past it.
    const std::size_t changes = 1 + random(3), kinds = random(2) == 0 ? 2 : 6;
    for (std::size_t i = 0; i < changes && !bytes.empty(); ++i) {
        const std::size_t at = random(bytes.size());
        switch (random(kinds)) {
        case 0:
            bytes[at] = char(random(256));
            break;
        case 1:
            bytes[at] = char(bytes[at] ^ (1 << random(8)));
            break;
        case 2:
            bytes.erase(at, random(40));
            break;
        case 3:
            bytes.insert(at, bytes.substr(random(bytes.size()), random(60)));
            break;
        case 4:
            bytes.resize(at);
            break;
        default: { // a number of the JSON becomes something else
            const std::size_t digit = bytes.find_first_of("0123456789", at);
            if (digit == std::string::npos)
                break;
            const std::size_t end = bytes.find_first_not_of("0123456789.eE+-", digit);
            bytes.replace(digit, (end == std::string::npos ? bytes.size() : end) - digit, words[random(words.size())]);
        }
        }
    }
    return bytes;
}

} // namespace sunfleck::tests

// Writes every built-in scene into a folder: generate_scenes FOLDER
#include "assets/test_rooms.h"
#include "engine/core/log.h"
#include "engine/io/scene_file.h"

#include <filesystem>

int main(int argc, char** argv) {
    using namespace sunfleck;
    if (argc != 2 || argv[1][0] == '-') {
        log_error("usage: generate_scenes FOLDER");
        return 2;
    }
    const std::filesystem::path folder = argv[1];
    std::error_code code;
    std::filesystem::create_directories(folder, code);
    for (const assets::BuiltInScene& built_in : assets::built_in_scenes()) {
        ecs::Registry registry;
        scene::MeshStore meshes;
        assets::SceneBuilder builder(registry, meshes);
        built_in.make(builder);
        const std::filesystem::path path = folder / (std::string(built_in.name) + ".scene.json");
        std::filesystem::remove(path, code); // saving over an older file would give the geometry another name
        const Status status = io::save_scene(path, registry, meshes, {});
        if (!status) {
            log_error(status.error().message);
            return 1;
        }
    }
    return 0;
}

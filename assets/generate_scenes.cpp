// Writes every built-in scene into a folder: generate_scenes FOLDER
#include "assets/test_rooms.h"
#include "engine/core/exit_status.h"
#include "engine/core/output.h"
#include "engine/core/program_end.h"
#include "engine/core/stop_signals.h"
#include "engine/io/scene_file.h"

#include <cstdio>
#include <filesystem>
#include <string_view>

namespace sunfleck {
namespace {

constexpr const char* usage = "usage: generate_scenes FOLDER\n";

// A save over an older file gives the geometry another name, so that the old scene is whole until the new one is; the
// save after that gives it the first name again, by which the scene's bytes are the same at each build.
Status save(const std::filesystem::path& folder, const assets::BuiltInScene& built_in) {
    ecs::Registry registry;
    scene::MeshStore meshes;
    assets::SceneBuilder builder(registry, meshes);
    built_in.make(builder);
    const std::string name(built_in.name);
    SUNFLECK_TRY(io::save_scene(folder / (name + ".scene.json"), registry, meshes, {}));
    std::error_code code;
    return std::filesystem::exists(folder / (name + ".glb"), code)
               ? Status()
               : io::save_scene(folder / (name + ".scene.json"), registry, meshes, {});
}

Status save_all(const std::filesystem::path& folder) {
    std::error_code code;
    std::filesystem::create_directories(folder, code);
    if (code)
        return Error{"cannot create folder '" + folder.string() + "': " + code.message()};
    for (const assets::BuiltInScene& built_in : assets::built_in_scenes())
        SUNFLECK_TRY(save(folder, built_in));
    return {};
}

} // namespace
} // namespace sunfleck

int main(int argc, char** argv) {
    using namespace sunfleck;
    hold_standard_streams();
    if (argc == 2 && std::string_view(argv[1]) == "--help") {
        std::fputs(usage, stdout);
        return printed(exit_done);
    }
    if (argc != 2 || argv[1][0] == '-' || argv[1][0] == '\0') {
        std::fputs(usage, stderr);
        return exit_usage;
    }
    end_at_interrupts();
    return run_to_end([&] { return save_all(argv[1]); });
}

#include "viewer/built_in_scenes.h"

#include "engine/core/file.h"
#include "viewer/option_values.h"

#include <algorithm>
#include <cstdlib>

namespace sunfleck::viewer {
namespace {

std::filesystem::path scene_folder() {
    if (const char* environment = std::getenv("SUNFLECK_SCENES"))
        return environment;
    std::error_code code;
    const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", code);
    for (const char* place : {"../scenes", "../share/sunfleck/scenes"}) {
        std::filesystem::path folder = program.parent_path() / place;
        if (std::filesystem::is_directory(folder, code))
            return folder;
    }
    return program.parent_path() / "../scenes";
}

Error unknown_name(const std::string& scene) {
    const std::vector<std::string> known = built_in_scene_names();
    std::string names;
    for (const std::string& name : known)
        names += (names.empty() ? "" : ", ") + name;
    return Error{"no built-in scene is called '" + scene + "'" + suggestion(scene, known) + " (there are: " + names +
                 "), and no such file exists"};
}

} // namespace

std::vector<std::string> built_in_scene_names() {
    std::vector<std::string> names;
    std::error_code code;
    for (const std::filesystem::path& path : folder_content(scene_folder(), code)) {
        const std::string file = path.filename().string();
        if (const std::size_t end = file.find(".scene.json"); end != std::string::npos)
            names.push_back(file.substr(0, end));
    }
    std::sort(names.begin(), names.end());
    return names;
}

Result<std::filesystem::path> find_scene(const std::string& scene) {
    std::error_code code;
    if (scene.find('/') == std::string::npos && scene.find('.') == std::string::npos) {
        std::filesystem::path built_in = scene_folder() / (scene + ".scene.json");
        if (std::filesystem::exists(built_in, code))
            return built_in;
        if (!std::filesystem::exists(scene, code))
            return unknown_name(scene);
    }
    if (!std::filesystem::exists(scene, code))
        return Error{"scene file '" + scene + "' does not exist"};
    return std::filesystem::path(scene);
}

} // namespace sunfleck::viewer

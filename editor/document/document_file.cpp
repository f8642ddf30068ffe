// Saving a document.
#include "editor/document/document.h"

#include "engine/core/file.h"

namespace sunfleck::editor {
namespace {

constexpr std::string_view scene_ending = ".scene.json";

} // namespace

Status Document::save(const std::filesystem::path& path) {
    commit();
    const std::string file = path.filename().string();
    if (!file.ends_with(scene_ending) || file.size() == scene_ending.size())
        return Error{"cannot save '" + path.string() + "': the name of a scene file ends in .scene.json"};
    std::error_code code;
    const std::string stem = file.substr(0, file.find('.'));
    const std::filesystem::path geometry = path.parent_path() / (stem + ".glb");
    if (!std::filesystem::exists(path, code) && std::filesystem::exists(geometry, code))
        return Error{"cannot save '" + path.string() + "': '" + geometry.filename().string() +
                     "' is there and belongs to something else; choose another name"};
    io::SaveOptions options;
    options.settings = viewer::unusual_lighting(settings_);
    SUNFLECK_TRY(io::save_scene(path, registry_, meshes_, textures_, options));
    path_ = path;
    saved_serial_ = history_.serial();
    return {};
}

} // namespace sunfleck::editor

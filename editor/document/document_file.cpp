// Saving a document.
#include "editor/document/document.h"

#include "engine/core/file.h"

namespace sunfleck::editor {
namespace {

constexpr std::string_view scene_ending = ".scene.json";

} // namespace

std::optional<Document::Stamp> Document::stamp_of(const std::filesystem::path& path) {
    std::error_code no_time, no_size;
    const Stamp stamp{std::filesystem::last_write_time(path, no_time), std::filesystem::file_size(path, no_size)};
    return no_time || no_size ? std::nullopt : std::optional(stamp);
}

bool Document::file_changed() const {
    const std::optional<Stamp> now = stamp_of(path_);
    return stamp_ && now && *now != *stamp_;
}

bool Document::is_another_file(const std::filesystem::path& path) const {
    std::error_code code;
    return path != path_ && std::filesystem::exists(path, code) && !std::filesystem::equivalent(path, path_, code);
}

Status Document::save(const std::filesystem::path& path, Replace replace) {
    commit();
    const std::string file = path.filename().string();
    if (!file.ends_with(scene_ending) || file.size() == scene_ending.size())
        return Error{"cannot save '" + path.string() + "': the name of a scene file ends in .scene.json"};
    const bool is_another = is_another_file(path);
    if (is_another && replace == Replace::own)
        return Error{"cannot save '" + path.string() +
                     "': there is a file of that name, of another scene; choose another name"};
    if (!is_another && file_changed() && stamp_of(path)) {
        stamp_ = stamp_of(path_);
        return Error{"'" + path.string() +
                     "' was changed by another program since it was opened; save once more to replace that, or under "
                     "another name to keep both"};
    }
    std::error_code code;
    const std::string stem = file.substr(0, file.find('.'));
    const std::filesystem::path geometry = path.parent_path() / (stem + ".glb");
    if (path != path_ && !std::filesystem::exists(path, code) && std::filesystem::exists(geometry, code))
        return Error{"cannot save '" + path.string() + "': '" + geometry.filename().string() +
                     "' is there and belongs to something else; choose another name"};
    io::SaveOptions options;
    options.settings = viewer::unusual_lighting(settings_);
    options.exact = true;
    SUNFLECK_TRY(io::save_scene(path, registry_, meshes_, textures_, options));
    path_ = path;
    stamp_ = stamp_of(path);
    saved_serial_ = history_.serial();
    return {};
}

} // namespace sunfleck::editor

// Saving a document.
#include "editor/document/document.h"

#include "engine/core/file.h"

namespace sunfleck::editor {
namespace {

constexpr std::string_view scene_ending = ".scene.json";

} // namespace

bool Document::file_changed() const {
    return FileStamp::changed(path_, stamp_);
}

bool Document::is_another_file(const std::filesystem::path& path) const {
    std::error_code code;
    return path != path_ && std::filesystem::exists(path, code) && !std::filesystem::equivalent(path, path_, code);
}

Status Document::may_save(const std::filesystem::path& path, Replace replace) {
    commit();
    const std::string file = path.filename().string();
    if (!file.ends_with(scene_ending) || file.size() == scene_ending.size())
        return Error{"cannot save '" + path.string() + "': the name of a scene file ends in .scene.json"};
    const bool is_another = is_another_file(path);
    if (is_another && replace == Replace::own)
        return Error{"cannot save '" + path.string() +
                     "': there is a file of that name, of another scene; choose another name"};
    if (!is_another && file_changed() && FileStamp::of(path)) {
        stamp_ = FileStamp::of(path_);
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
    return {};
}

io::SaveOptions Document::save_options(const gi::Settings& settings, io::EncodedTextures* encoded,
                                       const std::string* source) {
    io::SaveOptions options;
    options.settings = viewer::unusual_lighting(settings);
    options.exact = true;
    options.encoded = encoded;
    if (source != nullptr)
        options.source = *source;
    return options;
}

void Document::note_saved(const std::filesystem::path& path, std::uint64_t serial) {
    path_ = path;
    folder_ = path.parent_path();
    stamp_ = FileStamp::of(path);
    saved_serial_ = serial;
}

Status Document::save(const std::filesystem::path& path, Replace replace) {
    SUNFLECK_TRY(may_save(path, replace));
    const io::SaveOptions options = save_options(settings_, encoded_.get(), source_.get());
    SUNFLECK_TRY(io::save_scene(path, registry_, meshes_, textures_, options));
    note_saved(path, history_.serial());
    return {};
}

} // namespace sunfleck::editor

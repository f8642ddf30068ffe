#include "engine/io/scene_file.h"

#include "engine/core/file.h"
#include "engine/core/hash.h"
#include "engine/core/output.h"
#include "engine/io/encoded_textures.h"
#include "engine/io/gltf_checks.h"
#include "engine/io/scene_components.h"
#include "engine/io/sky_pictures.h"
#include "engine/scene/deformation.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <set>

namespace sunfleck::io {
namespace {

using nlohmann::json;

// As hexadecimal digits.
std::string checksum_of(std::string_view bytes) {
    return fmt::format("{:016x}", hash_bytes(hash_start, bytes.data(), bytes.size()));
}

bool is_utf8(const std::string& text) {
    return json::parse(json(text).dump(-1, ' ', false, json::error_handler_t::ignore)) == json(text);
}

std::string settings_text(const json& value) {
    return value.is_string() ? value.get<std::string>() : value.dump();
}

// Checks the version, and that the file has not been damaged since it was saved.
Status check_file(const json& file) {
    if (file.is_discarded() || !file.is_object())
        return Error{"it is not valid JSON"};
    const auto version = file.find("sunfleck_scene");
    if (version == file.end() || !version->is_number_integer() || *version < 1 || *version > scene_file_version)
        return Error{fmt::format("it is not a scene file of version 1 to {}", scene_file_version)};
    if (const auto checksum = file.find("checksum"); checksum != file.end()) {
        json content = file;
        content.erase("checksum");
        if (*checksum != checksum_of(content.dump()))
            return Error{"its checksum is wrong: it is damaged, or was edited (then remove its line \"checksum\")"};
    }
    for (const auto& [key, value] : file.items())
        if (key != "sunfleck_scene" && key != "checksum" && key != "gltf" && key != "gltf_checksum" &&
            key != "entities" && key != "settings" && key != "default_light" && key != "source")
            return Error{"it has an unknown key '" + key + "'"};
    if (!file.contains("gltf") || !file["gltf"].is_string())
        return Error{"it names no glTF file"};
    for (const char* key : {"entities", "settings", "source"})
        if (file.contains(key) && !file[key].is_object())
            return Error{fmt::format("'{}' must be an object", key)};
    if (file.contains("default_light") && !file["default_light"].is_boolean())
        return Error{"'default_light' must be true or false"};
    return {};
}

Status check_gltf_file(const json& file, const std::filesystem::path& gltf, FileAccess access) {
    SUNFLECK_TRY(access.check(gltf));
    const auto expected = file.find("gltf_checksum");
    if (expected == file.end())
        return {};
    access.content_hash = nullptr; // the import reads it
    SUNFLECK_ASSIGN(const std::string bytes, access.read(gltf));
    if (*expected != checksum_of(bytes))
        return Error{"'" + gltf.filename().string() +
                     "' is damaged, or was changed (then remove the line \"gltf_checksum\")"};
    return {};
}

Result<ImportReport> load_scene_file(const std::filesystem::path& path, ecs::Registry& registry,
                                     scene::MeshStore& meshes, scene::TextureStore& textures,
                                     const ImportOptions& options) {
    const std::filesystem::path folder = real_folder(path);
    const FileAccess access{folder, options.allow_outside, options.content_hash};
    const FileAccess named{{}, true, options.content_hash}; // by the user
    SUNFLECK_ASSIGN(const std::string text, named.read(path, std::size_t(64) << 20));
    const auto failure = [&](const std::string& why) { return Error{"cannot load '" + path.string() + "': " + why}; };
    if (!nesting_is_sane(text))
        return failure("its JSON is nested too deeply");
    const json file = json::parse(text, nullptr, false);
    if (const Status status = check_file(file); !status)
        return failure(status.error().message);
    const std::filesystem::path gltf = folder / file["gltf"].get<std::string>();
    if (const Status status = check_gltf_file(file, gltf, access); !status)
        return failure(status.error().message);
    static const json nothing = json::object();
    const json& entities = file.contains("entities") ? file["entities"] : nothing;
    for (const auto& [name, components] : entities.items())
        if (const Status status = check_entity(name, components); !status)
            return failure(status.error().message);
    ImportOptions within = options;
    within.root = folder;
    auto report = import_gltf(gltf, registry, meshes, textures, within);
    if (!report)
        return failure(report.error().message);
    for (const auto& [name, components] : entities.items())
        if (const Status status = apply_entity(registry, name, components); !status)
            return failure(status.error().message);
    if (const Status status = load_sky_pictures(folder, access, registry, options.for_saving, report->notes); !status)
        return failure(status.error().message);
    const json& settings = file.contains("settings") ? file["settings"] : nothing;
    for (const auto& [name, value] : settings.items())
        report->settings[name] = settings_text(value);
    report->default_light = file.value("default_light", true);
    if (file.contains("source"))
        report->source = file["source"].dump();
    return report;
}

// But for surfaces that shine.
bool has_light(const ecs::Registry& registry) {
    return registry.count<scene::AreaLight>() + registry.count<scene::PointLight>() +
               registry.count<scene::SpotLight>() + registry.count<scene::DirectionalLight>() +
               registry.count<scene::Environment>() >
           0;
}

Status check_names(ecs::Registry& registry) {
    std::set<std::string> names;
    for (const ecs::Entity entity : registry.entities())
        if (const scene::Name* name = registry.try_get<scene::Name>(entity))
            if (!names.insert(name->name).second)
                return Error{"two entities are called '" + name->name + "'"};
    return {};
}

// Without its extensions; a name that JSON cannot hold as percent signs and numbers.
std::string stem_of(const std::filesystem::path& path) {
    const std::string name = path.filename().string();
    const std::string stem = name.substr(0, name.find('.'));
    if (is_utf8(stem))
        return stem;
    std::string encoded;
    for (const char byte : stem)
        encoded += std::uint8_t(byte) < 0x80 ? std::string(1, byte) : fmt::format("%{:02x}", std::uint8_t(byte));
    return encoded.substr(0, 240); // names of files have 255 bytes at most
}

// What is written.
struct Content {
    ecs::Registry& registry;
    const scene::MeshStore& meshes;
    const scene::TextureStore& textures;
    EncodedTextures* encoded;
};

// Writes the .glb file beside the scene file at `path` and names it in `file`. Never overwrites the file `previous`
// that the existing scene file refers to: until the new scene file is written, the old pair must stay valid.
Status save_geometry(const std::filesystem::path& path, const std::string& previous, const Content& content,
                     json& file) {
    const std::string stem = stem_of(path);
    file["gltf"] = previous == stem + ".glb" ? stem + ".2.glb" : stem + ".glb";
    const std::filesystem::path gltf = path.parent_path() / file["gltf"].get<std::string>();
    auto bytes = gltf_bytes(content.registry, content.meshes, content.textures, content.encoded);
    if (!bytes)
        return Error{"cannot write '" + gltf.string() + "': " + bytes.error().message, bytes.error().code};
    SUNFLECK_TRY(write_file(gltf, *bytes));
    file["gltf_checksum"] = checksum_of(*bytes);
    return {};
}

// The .glb file that the scene file at `path` currently refers to, if any. An error where that can't be read: it could
// be any that lies there.
Result<std::string> named_gltf(const std::filesystem::path& path) {
    std::error_code code;
    if (!std::filesystem::is_regular_file(path, code))
        return std::string();
    SUNFLECK_ASSIGN(const std::string text, read_file(path));
    const json file = nesting_is_sane(text) ? json::parse(text, nullptr, false) : json();
    return file.is_object() && file.contains("gltf") && file["gltf"].is_string() ? file["gltf"].get<std::string>()
                                                                                 : std::string();
}

} // namespace

Result<ImportReport> load_scene(const std::filesystem::path& path, ecs::Registry& registry, scene::MeshStore& meshes,
                                scene::TextureStore& textures, const ImportOptions& options) {
    scene::register_components(registry);
    const bool scene_file = path.extension() == ".json";
    if (!scene_file && path.extension() != ".gltf" && path.extension() != ".glb")
        return Error{"cannot load '" + path.string() + "': the extension must be .gltf, .glb or .scene.json"};
    auto report = scene_file ? load_scene_file(path, registry, meshes, textures, options)
                             : import_gltf(path, registry, meshes, textures, options);
    scene::update_world_transforms(registry);
    scene::deform_meshes(registry, meshes);
    return report;
}

Status save_scene(const std::filesystem::path& named, ecs::Registry& registry, const scene::MeshStore& meshes,
                  const scene::TextureStore& textures, const SaveOptions& options) {
    const auto failure = [&](const std::string& why) { return Error{"cannot save '" + named.string() + "': " + why}; };
    SUNFLECK_ASSIGN(const OutputTarget target, find_output(named));
    const std::filesystem::path path = target.path; // the .glb file lies beside the scene file itself, not its link
    if (const Status status = check_names(registry); !status)
        return failure(status.error().message);
    const auto previous = named_gltf(path);
    if (!previous)
        return failure(previous.error().message);
    json file = {{"sunfleck_scene", options.source.empty() ? version_without_source : scene_file_version}};
    if (!options.gltf_reference.empty()) {
        const std::filesystem::path folder = real_folder(path);
        if (const Status status = FileAccess{folder}.check(folder / options.gltf_reference); !status)
            return failure(status.error().message);
        if (!is_utf8(options.gltf_reference))
            return failure("the name of '" + options.gltf_reference + "' is not UTF-8, and JSON holds nothing else");
        file["gltf"] = options.gltf_reference;
    } else {
        SUNFLECK_TRY(save_geometry(path, *previous, {registry, meshes, textures, options.encoded}, file));
    }
    file["entities"] = entities_json(registry, !options.gltf_reference.empty(), options.exact);
    if (const Status status = save_sky_pictures(path, registry, file["entities"]); !status)
        return failure(status.error().message);
    for (const auto& [setting, value] : options.settings)
        file["settings"][setting] = value;
    if (!options.source.empty())
        file["source"] = json::parse(options.source);
    if (options.exact && !has_light(registry))
        file["default_light"] = false;
    file["checksum"] = checksum_of(file.dump());
    SUNFLECK_TRY(write_file(path, file.dump(2) + "\n"));
    // What an earlier save has written, and nothing that someone else may have.
    std::error_code code;
    const std::string stem = stem_of(path);
    if (*previous != file["gltf"] && (*previous == stem + ".glb" || *previous == stem + ".2.glb"))
        std::filesystem::remove(path.parent_path() / *previous, code);
    return {};
}

} // namespace sunfleck::io

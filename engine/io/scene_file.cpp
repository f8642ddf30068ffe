#include "engine/io/scene_file.h"

#include "engine/core/file.h"
#include "engine/core/hash.h"
#include "engine/io/gltf_checks.h"
#include "engine/io/image.h"
#include "engine/scene/deformation.h"
#include "engine/scene/simulation_components.h"

#include <fmt/format.h>
#include <functional>
#include <nlohmann/json.hpp>
#include <set>

namespace sunfleck::io {
namespace {

using nlohmann::json;
constexpr int file_version = 2; // 1 had no checksums and no settings

// Components that glTF cannot say, with how to reach them by name.
struct ComponentAccess {
    const TypeDescription& type;
    const void* (*find)(ecs::Registry&, ecs::Entity);
    Status (*set)(ecs::Registry&, ecs::Entity, const std::function<Status(void*)>& fill);
    Status (*check)(const std::function<Status(void*)>& fill); // whether `set` would work
};

template <typename T>
ComponentAccess access() {
    return {T::description(),
            [](ecs::Registry& registry, ecs::Entity entity) -> const void* { return registry.try_get<T>(entity); },
            [](ecs::Registry& registry, ecs::Entity entity, const std::function<Status(void*)>& fill) -> Status {
                const T* stored = registry.try_get<T>(entity);
                T value = stored != nullptr ? *stored : T{};
                SUNFLECK_TRY(fill(&value));
                SUNFLECK_TRY(validate(T::description(), &value));
                registry.emplace_or_replace<T>(entity, value);
                return {};
            },
            [](const std::function<Status(void*)>& fill) -> Status {
                T value{};
                SUNFLECK_TRY(fill(&value));
                return validate(T::description(), &value);
            }};
}

const std::vector<ComponentAccess>& saved_components() {
    static const std::vector<ComponentAccess> list = {
        access<scene::AreaLight>(),     access<scene::Mover>(),          access<scene::Exposure>(),
        access<scene::Environment>(),   access<scene::SurfacePattern>(), access<scene::SplinePath>(),
        access<scene::RigidBody>(),     access<scene::LightSwitch>(),    access<scene::PlayerStart>(),
        access<scene::ShadowCasting>(), access<scene::Lantern>(),        access<scene::EnvironmentMap>()};
    return list;
}

// What glTF can say, but a user may have changed since: saved beside a reference to a file that is not ours to write.
const std::vector<ComponentAccess>& overridden_components() {
    static const std::vector<ComponentAccess> list = {access<scene::Transform>(), access<scene::Material>(),
                                                      access<scene::Camera>(),    access<scene::PointLight>(),
                                                      access<scene::SpotLight>(), access<scene::DirectionalLight>()};
    return list;
}

// As hexadecimal digits.
std::string checksum_of(std::string_view bytes) {
    return fmt::format("{:016x}", hash_bytes(hash_start, bytes.data(), bytes.size()));
}

json field_to_json(const Field& field, const void* object) {
    const std::string text = field_to_text(field, object);
    switch (field.kind) {
    case FieldKind::text:
    case FieldKind::choice:
        return text;
    case FieldKind::boolean:
        return text == "true";
    case FieldKind::vector3:
    case FieldKind::quaternion:
        return json::parse("[" + text + "]");
    default:
        return json::parse(text);
    }
}

json field_schema(const Field& field) {
    json schema = {
        {"description", std::string(field.tooltip) + (field.unit.empty() ? "" : ", " + std::string(field.unit))}};
    const json number = {{"type", "number"}, {"minimum", field.minimum}, {"maximum", field.maximum}};
    const auto list_of = [&](int count) {
        return json{{"type", "array"}, {"items", number}, {"minItems", count}, {"maxItems", count}};
    };
    switch (field.kind) {
    case FieldKind::boolean:
        schema["type"] = "boolean";
        break;
    case FieldKind::text:
        schema["type"] = "string";
        break;
    case FieldKind::choice:
        schema["enum"] = field.choices;
        break;
    case FieldKind::vector3:
        schema.update(list_of(3));
        break;
    case FieldKind::quaternion:
        schema.update(list_of(4));
        break;
    case FieldKind::integer:
    case FieldKind::unsigned_integer:
        schema.update(number);
        schema["type"] = "integer";
        break;
    default:
        schema.update(number);
    }
    return schema;
}

Status field_from_json(const Field& field, void* object, const json& value) {
    std::string text;
    if (value.is_string()) {
        text = value.get<std::string>();
    } else if (value.is_array()) {
        for (const json& element : value)
            text += (text.empty() ? "" : ",") + element.dump();
    } else {
        text = value.dump();
    }
    return field_from_text(field, object, text);
}

Status fill_component(const TypeDescription& type, void* object, const json& fields) {
    if (!fields.is_object())
        return Error{std::string(type.name) + " must be an object of fields"};
    for (const auto& [name, value] : fields.items()) {
        const Field* field = type.find(name);
        if (field == nullptr)
            return Error{std::string(type.name) + " has no field '" + name + "'"};
        SUNFLECK_TRY(field_from_json(*field, object, value));
    }
    return {};
}

const ComponentAccess* find_component(const std::string& name) {
    for (const auto* list : {&saved_components(), &overridden_components()})
        for (const ComponentAccess& candidate : *list)
            if (candidate.type.name == name)
                return &candidate;
    return nullptr;
}

Status check_entity(const std::string& name, const json& components) {
    if (!components.is_object())
        return Error{"entity '" + name + "' must be an object of components"};
    for (const auto& [component, fields] : components.items()) {
        const ComponentAccess* access = find_component(component);
        if (access == nullptr)
            return Error{"entity '" + name + "': unknown component '" + component + "'"};
        const Status status =
            access->check([&, &values = fields](void* object) { return fill_component(access->type, object, values); });
        if (!status)
            return Error{"entity '" + name + "': " + status.error().message};
    }
    return {};
}

// After check_entity; names that are no nodes make entities of the scene file's own.
Status apply_entity(ecs::Registry& registry, const std::string& name, const json& components) {
    ecs::Entity entity = scene::find_by_name(registry, name);
    if (entity.is_null()) {
        entity = registry.create();
        registry.emplace<scene::Name>(entity, {name});
    }
    for (const auto& [component, fields] : components.items()) {
        const ComponentAccess* access = find_component(component);
        SUNFLECK_TRY(access->set(registry, entity, [&, &values = fields](void* object) {
            return fill_component(access->type, object, values);
        }));
    }
    return {};
}

std::string settings_text(const json& value) {
    return value.is_string() ? value.get<std::string>() : value.dump();
}

// The version, and that nothing has been damaged since it was saved.
Status check_file(const json& file) {
    if (file.is_discarded() || !file.is_object())
        return Error{"it is not valid JSON"};
    const auto version = file.find("sunfleck_scene");
    if (version == file.end() || !version->is_number_integer() || *version < 1 || *version > file_version)
        return Error{fmt::format("it is not a scene file of version 1 to {}", file_version)};
    if (const auto checksum = file.find("checksum"); checksum != file.end()) {
        json content = file;
        content.erase("checksum");
        if (*checksum != checksum_of(content.dump()))
            return Error{"its checksum is wrong: it is damaged, or was edited (then remove its line \"checksum\")"};
    }
    for (const auto& [key, value] : file.items())
        if (key != "sunfleck_scene" && key != "checksum" && key != "gltf" && key != "gltf_checksum" &&
            key != "entities" && key != "settings")
            return Error{"it has an unknown entry '" + key + "'"};
    if (!file.contains("gltf") || !file["gltf"].is_string())
        return Error{"it names no glTF file"};
    for (const char* key : {"entities", "settings"})
        if (file.contains(key) && !file[key].is_object())
            return Error{fmt::format("'{}' must be an object", key)};
    return {};
}

Status check_gltf_file(const json& file, const std::filesystem::path& gltf) {
    const auto expected = file.find("gltf_checksum");
    if (expected == file.end())
        return {};
    SUNFLECK_ASSIGN(const std::string bytes, read_file(gltf));
    if (*expected != checksum_of(bytes))
        return Error{"'" + gltf.filename().string() +
                     "' is damaged, or was changed (then remove the line \"gltf_checksum\")"};
    return {};
}

Status load_environment_maps(const std::filesystem::path& folder, ecs::Registry& registry) {
    std::vector<ecs::Entity> entities;
    registry.view<scene::EnvironmentMap>().each(
        [&](ecs::Entity entity, const scene::EnvironmentMap&) { entities.push_back(entity); });
    for (const ecs::Entity entity : entities) {
        const std::string file = registry.get<scene::EnvironmentMap>(entity).file;
        SUNFLECK_ASSIGN(auto image, load_environment_image(folder / file));
        registry.patch<scene::EnvironmentMap>(entity,
                                              [&](scene::EnvironmentMap& map) { map.image = std::move(image); });
    }
    return {};
}

Result<ImportReport> load_scene_file(const std::filesystem::path& path, ecs::Registry& registry,
                                     scene::MeshStore& meshes, scene::TextureStore& textures,
                                     const ImportOptions& options) {
    SUNFLECK_ASSIGN(const std::string text, read_file(path, std::size_t(64) << 20));
    const auto failure = [&](const std::string& why) { return Error{"cannot load '" + path.string() + "': " + why}; };
    if (!nesting_is_sane(text))
        return failure("its JSON is nested too deeply");
    const json file = json::parse(text, nullptr, false);
    if (const Status status = check_file(file); !status)
        return failure(status.error().message);
    const std::filesystem::path gltf = path.parent_path() / file["gltf"].get<std::string>();
    if (const Status status = check_gltf_file(file, gltf); !status)
        return failure(status.error().message);
    static const json nothing = json::object();
    const json& entities = file.contains("entities") ? file["entities"] : nothing;
    for (const auto& [name, components] : entities.items())
        if (const Status status = check_entity(name, components); !status)
            return failure(status.error().message);
    auto report = import_gltf(gltf, registry, meshes, textures, options);
    if (!report)
        return failure(report.error().message);
    for (const auto& [name, components] : entities.items())
        if (const Status status = apply_entity(registry, name, components); !status)
            return failure(status.error().message);
    if (const Status status = load_environment_maps(path.parent_path(), registry); !status)
        return failure(status.error().message);
    const json& settings = file.contains("settings") ? file["settings"] : nothing;
    for (const auto& [name, value] : settings.items())
        report->settings[name] = settings_text(value);
    return report;
}

json entities_json(ecs::Registry& registry, bool overridden) {
    json entities = json::object();
    for (const ecs::Entity entity : registry.entities()) {
        const scene::Name* name = registry.try_get<scene::Name>(entity);
        if (name == nullptr)
            continue;
        const auto add = [&](const std::vector<ComponentAccess>& list) {
            for (const ComponentAccess& access : list)
                if (const void* object = access.find(registry, entity))
                    for (const Field& field : access.type.fields)
                        entities[name->name][std::string(access.type.name)][std::string(field.name)] =
                            field_to_json(field, object);
        };
        add(saved_components());
        if (overridden)
            add(overridden_components());
    }
    return entities;
}

Status check_names(ecs::Registry& registry) {
    std::set<std::string> names;
    for (const ecs::Entity entity : registry.entities())
        if (const scene::Name* name = registry.try_get<scene::Name>(entity))
            if (!names.insert(name->name).second)
                return Error{"two entities are called '" + name->name + "'"};
    return {};
}

// The .glb file that the scene file at `path` names now, if there is one.
std::string named_gltf(const std::filesystem::path& path) {
    const auto text = read_file(path, std::size_t(64) << 20);
    const json file = text && nesting_is_sane(*text) ? json::parse(*text, nullptr, false) : json();
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

Status save_scene(const std::filesystem::path& path, ecs::Registry& registry, const scene::MeshStore& meshes,
                  const scene::TextureStore& textures, const SaveOptions& options) {
    const auto failure = [&](const std::string& why) { return Error{"cannot save '" + path.string() + "': " + why}; };
    if (const Status status = check_names(registry); !status)
        return failure(status.error().message);
    const std::string previous = named_gltf(path);
    json file = {{"sunfleck_scene", file_version}};
    if (!options.gltf_reference.empty()) {
        file["gltf"] = options.gltf_reference;
    } else {
        // Not over the file that the present scene file names: until the new one stands, the old pair is whole.
        const std::string name = path.filename().string();
        const std::string stem = name.substr(0, name.find('.'));
        file["gltf"] = previous == stem + ".glb" ? stem + ".2.glb" : stem + ".glb";
        const std::filesystem::path gltf = path.parent_path() / file["gltf"].get<std::string>();
        SUNFLECK_TRY(export_gltf(gltf, registry, meshes, textures));
        SUNFLECK_ASSIGN(const std::string bytes, read_file(gltf));
        file["gltf_checksum"] = checksum_of(bytes);
    }
    file["entities"] = entities_json(registry, !options.gltf_reference.empty());
    for (const auto& [setting, value] : options.settings)
        file["settings"][setting] = value;
    file["checksum"] = checksum_of(file.dump());
    SUNFLECK_TRY(write_file(path, file.dump(2) + "\n"));
    std::error_code code;
    const bool ours = previous == file["gltf"] ? false : previous.ends_with(".glb") && options.gltf_reference.empty();
    if (ours && previous.find('/') == std::string::npos)
        std::filesystem::remove(path.parent_path() / previous, code);
    return {};
}

Result<std::shared_ptr<const scene::EnvironmentImage>> load_environment_image(const std::filesystem::path& path) {
    SUNFLECK_ASSIGN(const std::string bytes, read_file(path));
    const auto kind = sniff_picture(bytes);
    auto picture = decode_picture(bytes);
    if (!picture)
        return Error{"environment map '" + path.string() + "': " + picture.error().message};
    std::vector<vec3> texels;
    texels.reserve(picture->pixels.size());
    const bool display = kind == PictureKind::png || kind == PictureKind::jpeg;
    for (const vec4& pixel : picture->pixels)
        texels.push_back(display ? vec3(scene::linear_from_srgb(pixel.x), scene::linear_from_srgb(pixel.y),
                                        scene::linear_from_srgb(pixel.z))
                                 : vec3(pixel));
    return std::make_shared<const scene::EnvironmentImage>(picture->width, picture->height, std::move(texels));
}

std::string scene_file_schema() {
    json entity = {{"type", "object"}, {"additionalProperties", false}, {"properties", json::object()}};
    for (const auto* list : {&saved_components(), &overridden_components()})
        for (const ComponentAccess& access : *list) {
            json component = {{"type", "object"},
                              {"description", access.type.tooltip},
                              {"additionalProperties", false},
                              {"properties", json::object()}};
            for (const Field& field : access.type.fields)
                component["properties"][std::string(field.name)] = field_schema(field);
            entity["properties"][std::string(access.type.name)] = component;
        }
    const json schema = {
        {"$schema", "https://json-schema.org/draft/2020-12/schema"},
        {"title", "Sunfleck scene file"},
        {"type", "object"},
        {"required", {"sunfleck_scene", "gltf"}},
        {"properties",
         {{"sunfleck_scene",
           {{"description", "Version"}, {"type", "integer"}, {"minimum", 1}, {"maximum", file_version}}},
          {"gltf", {{"description", "glTF file, relative to this one"}, {"type", "string"}}},
          {"gltf_checksum",
           {{"description", "FNV-1a of that file; leave it out when it may change"}, {"type", "string"}}},
          {"checksum",
           {{"description", "FNV-1a of this file without this line; leave it out when editing by hand"},
            {"type", "string"}}},
          {"settings", {{"description", "Lighting settings by name, as sunfleck info lists them"}, {"type", "object"}}},
          {"entities",
           {{"description",
             "Components by name of the entity; a name that is no node of the glTF file makes a new one"},
            {"type", "object"},
            {"additionalProperties", entity}}}}}};
    return schema.dump(2) + "\n";
}

} // namespace sunfleck::io

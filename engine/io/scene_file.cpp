#include "engine/io/scene_file.h"

#include "engine/core/file.h"
#include "engine/scene/simulation_components.h"

#include <functional>
#include <nlohmann/json.hpp>
#include <set>

namespace sunfleck::io {
namespace {

using nlohmann::json;
constexpr int file_version = 1;

// Components that glTF cannot say, with how to reach them by name.
struct ComponentAccess {
    const TypeDescription& type;
    const void* (*find)(ecs::Registry&, ecs::Entity);
    Status (*set)(ecs::Registry&, ecs::Entity, const std::function<Status(void*)>& fill);
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
            }};
}

const std::vector<ComponentAccess>& saved_components() {
    static const std::vector<ComponentAccess> list = {
        access<scene::AreaLight>(),     access<scene::Mover>(),          access<scene::Exposure>(),
        access<scene::Environment>(),   access<scene::SurfacePattern>(), access<scene::SplinePath>(),
        access<scene::RigidBody>(),     access<scene::LightSwitch>(),    access<scene::PlayerStart>(),
        access<scene::ShadowCasting>(), access<scene::Lantern>()};
    return list;
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

Status apply_entity(ecs::Registry& registry, const std::string& name, const json& components) {
    ecs::Entity entity = scene::find_by_name(registry, name);
    if (entity.is_null()) { // not a node: an entity of the scene file's own
        entity = registry.create();
        registry.emplace<scene::Name>(entity, {name});
    }
    if (!components.is_object())
        return Error{"entity '" + name + "' must be an object of components"};
    for (const auto& [component, fields] : components.items()) {
        const ComponentAccess* access = nullptr;
        for (const ComponentAccess& candidate : saved_components())
            if (candidate.type.name == component)
                access = &candidate;
        if (access == nullptr)
            return Error{"entity '" + name + "': unknown component '" + component + "'"};
        const Status status =
            access->set(registry, entity, [&](void* object) { return fill_component(access->type, object, fields); });
        if (!status)
            return Error{"entity '" + name + "': " + status.error().message};
    }
    return {};
}

Result<ImportReport> load_scene_file(const std::filesystem::path& path, ecs::Registry& registry,
                                     scene::MeshStore& meshes) {
    SUNFLECK_ASSIGN(const std::string text, read_file(path, std::size_t(64) << 20));
    const json file = json::parse(text, nullptr, false);
    const auto failure = [&](const std::string& why) { return Error{"cannot load '" + path.string() + "': " + why}; };
    if (file.is_discarded() || !file.is_object())
        return failure("it is not valid JSON");
    if (!file.contains("sunfleck_scene") || file["sunfleck_scene"] != file_version)
        return failure("it is not a scene file of version " + std::to_string(file_version));
    if (!file.contains("gltf") || !file["gltf"].is_string())
        return failure("it names no glTF file");
    const std::filesystem::path gltf = std::filesystem::path(file["gltf"].get<std::string>()).filename();
    SUNFLECK_ASSIGN(const ImportReport report, import_gltf(path.parent_path() / gltf, registry, meshes));
    if (file.contains("entities")) {
        if (!file["entities"].is_object())
            return failure("'entities' must be an object");
        for (const auto& [name, components] : file["entities"].items())
            if (const Status status = apply_entity(registry, name, components); !status)
                return failure(status.error().message);
    }
    return report;
}

} // namespace

Result<ImportReport> load_scene(const std::filesystem::path& path, ecs::Registry& registry, scene::MeshStore& meshes) {
    scene::register_components(registry);
    const bool scene_file = path.extension() == ".json";
    if (!scene_file && path.extension() != ".gltf" && path.extension() != ".glb")
        return Error{"cannot load '" + path.string() + "': the extension must be .gltf, .glb or .scene.json"};
    auto report = scene_file ? load_scene_file(path, registry, meshes) : import_gltf(path, registry, meshes);
    scene::update_world_transforms(registry);
    return report;
}

Status save_scene(const std::filesystem::path& path, ecs::Registry& registry, const scene::MeshStore& meshes) {
    std::string stem = path.filename().string();
    stem = stem.substr(0, stem.find('.'));
    json entities = json::object();
    std::set<std::string> names;
    for (const ecs::Entity entity : registry.entities()) {
        const scene::Name* name = registry.try_get<scene::Name>(entity);
        if (name == nullptr)
            continue;
        if (!names.insert(name->name).second)
            return Error{"cannot save '" + path.string() + "': two entities are called '" + name->name + "'"};
        for (const ComponentAccess& access : saved_components())
            if (const void* object = access.find(registry, entity))
                for (const Field& field : access.type.fields)
                    entities[name->name][std::string(access.type.name)][std::string(field.name)] =
                        field_to_json(field, object);
    }
    SUNFLECK_TRY(export_gltf(path.parent_path() / (stem + ".glb"), registry, meshes));
    const json file = {{"sunfleck_scene", file_version}, {"gltf", stem + ".glb"}, {"entities", entities}};
    return write_file(path, file.dump(2) + "\n");
}

} // namespace sunfleck::io

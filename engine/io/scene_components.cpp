#include "engine/io/scene_components.h"

#include "engine/scene/animation.h"
#include "engine/scene/deformation.h"
#include "engine/scene/environment_map.h"
#include "engine/scene/simulation_components.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace sunfleck::io {

using nlohmann::json;

namespace {

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
            },
            [](ecs::Registry& registry, ecs::Entity entity) {
                if (registry.has<T>(entity))
                    registry.remove<T>(entity);
            }};
}

} // namespace

const std::vector<ComponentAccess>& saved_components() {
    static const std::vector<ComponentAccess> list = {
        access<scene::AreaLight>(),     access<scene::Mover>(),          access<scene::Exposure>(),
        access<scene::Environment>(),   access<scene::SurfacePattern>(), access<scene::SplinePath>(),
        access<scene::RigidBody>(),     access<scene::LightSwitch>(),    access<scene::PlayerStart>(),
        access<scene::ShadowCasting>(), access<scene::Lantern>(),        access<scene::EnvironmentMap>(),
        access<scene::LightSensor>(),   access<scene::GameArea>()};
    return list;
}

const std::vector<ComponentAccess>& overridden_components() {
    static const std::vector<ComponentAccess> list = {access<scene::Transform>(), access<scene::Material>(),
                                                      access<scene::Camera>(),    access<scene::PointLight>(),
                                                      access<scene::SpotLight>(), access<scene::DirectionalLight>()};
    return list;
}

namespace {

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

const ComponentAccess* find_component(const std::string& name) {
    for (const auto* list : {&saved_components(), &overridden_components()})
        for (const ComponentAccess& candidate : *list)
            if (candidate.type.name == name)
                return &candidate;
    return nullptr;
}

} // namespace

Status check_entity(const std::string& name, const json& components) {
    if (!components.is_object())
        return Error{"entity '" + name + "' must be an object of components"};
    for (const auto& [component, fields] : components.items()) {
        const ComponentAccess* access = find_component(component);
        if (access == nullptr)
            return Error{"entity '" + name + "': unknown component '" + component + "'"};
        if (fields.is_null())
            continue;
        const Status status =
            access->check([&, &values = fields](void* object) { return fill_component(access->type, object, values); });
        if (!status)
            return Error{"entity '" + name + "': " + status.error().message};
    }
    return {};
}

Status apply_entity(ecs::Registry& registry, const std::string& name, const json& components) {
    ecs::Entity entity = scene::find_by_name(registry, name);
    if (entity.is_null()) {
        entity = registry.create();
        registry.emplace<scene::Name>(entity, {name});
    }
    for (const auto& [component, fields] : components.items()) {
        const ComponentAccess* access = find_component(component);
        if (fields.is_null()) {
            access->remove(registry, entity);
            continue;
        }
        SUNFLECK_TRY(access->set(registry, entity, [&, &values = fields](void* object) {
            return fill_component(access->type, object, values);
        }));
    }
    return {};
}

namespace {

// The import makes a mover of it.
bool moves_in_gltf(const ecs::Registry& registry, ecs::Entity entity) {
    const auto* animation = registry.try_get<scene::Animation>(entity);
    return (animation != nullptr && !animation->curves.empty()) || registry.has<scene::Deformation>(entity);
}

} // namespace

json entities_json(ecs::Registry& registry, bool overridden, bool exact) {
    json entities = json::object();
    for (const ecs::Entity entity : registry.entities()) {
        const scene::Name* name = registry.try_get<scene::Name>(entity);
        if (name == nullptr)
            continue;
        const auto add = [&](const ComponentAccess& access) {
            if (const void* object = access.find(registry, entity))
                for (const Field& field : access.type.fields)
                    entities[name->name][std::string(access.type.name)][std::string(field.name)] =
                        field_to_json(field, object);
        };
        for (const ComponentAccess& access : saved_components())
            add(access);
        for (const ComponentAccess& access : overridden_components())
            if (overridden)
                add(access);
        if (!exact)
            continue;
        const bool has_geometry = registry.has<scene::MeshInstance>(entity);
        if (!registry.has<scene::Transform>(entity))
            entities[name->name][std::string(scene::Transform::description().name)] = nullptr;
        if (has_geometry && !registry.has<scene::Material>(entity))
            entities[name->name][std::string(scene::Material::description().name)] = nullptr;
        if (moves_in_gltf(registry, entity) && !registry.has<scene::Mover>(entity))
            entities[name->name][std::string(scene::Mover::description().name)] = nullptr;
        if (!has_geometry)
            add(*find_component(std::string(scene::Material::description().name)));
        const std::string_view lights[] = {scene::PointLight::description().name, scene::SpotLight::description().name,
                                           scene::DirectionalLight::description().name};
        const auto has = [&](std::string_view type) {
            return find_component(std::string(type))->find(registry, entity) != nullptr;
        };
        if (std::count_if(std::begin(lights), std::end(lights), has) > 1)
            for (const std::string_view light : lights)
                add(*find_component(std::string(light)));
    }
    return entities;
}

} // namespace sunfleck::io

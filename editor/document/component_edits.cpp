// Edits of components and settings, all from their descriptions.
#include "editor/document/edits.h"
#include "engine/scene/simulation_components.h"

#include <algorithm>

namespace sunfleck::editor {
namespace {

// "base_colour" -> "base colour".
std::string readable(std::string_view name) {
    std::string result(name);
    std::replace(result.begin(), result.end(), '_', ' ');
    return result;
}

} // namespace

bool is_part_of_tree(Document& document, const ecs::PoolBase& pool) {
    return &pool == &pool_of<scene::Name>(document) || &pool == &pool_of<scene::Parent>(document) ||
           &pool == &pool_of<scene::MeshInstance>(document);
}

void add_component(Document& document, const Entities& entities, ecs::PoolBase& pool) {
    document.begin("Add " + std::string(pool.description()->name) + " to " + what(document, entities));
    for (const Entity entity : entities)
        if (!pool.contains(entity))
            document.set(entity, pool, pool.default_value());
    document.commit();
}

void remove_component(Document& document, const Entities& entities, ecs::PoolBase& pool) {
    document.begin("Remove " + std::string(pool.description()->name) + " from " + what(document, entities));
    for (const Entity entity : entities)
        if (pool.contains(entity))
            document.set(entity, pool, nullptr);
    document.commit();
}

void paste_component(Document& document, const Entities& entities, ecs::PoolBase& pool, const ecs::Value& value) {
    document.begin("Paste " + std::string(pool.description()->name) + " to " + what(document, entities));
    for (const Entity entity : entities)
        document.set(entity, pool, value);
    document.commit();
}

Status set_field(Document& document, const Entities& entities, ecs::PoolBase& pool, const Field& field,
                 std::string_view text) {
    std::vector<std::pair<Entity, std::shared_ptr<void>>> values;
    for (const Entity entity : entities) {
        if (!pool.contains(entity))
            continue;
        values.emplace_back(entity, pool.copy_value(pool.address(pool.position_of(entity.index))));
        SUNFLECK_TRY(field_from_text(field, values.back().second.get(), text));
        SUNFLECK_TRY(validate(*pool.description(), values.back().second.get()));
    }
    for (auto& [entity, value] : values)
        document.set(entity, pool, std::move(value));
    return {};
}

Status edit_field(Document& document, const Entities& entities, ecs::PoolBase& pool, const Field& field,
                  std::string_view text) {
    document.begin("Set " + readable(field.name) + " of " + what(document, entities));
    Status status = set_field(document, entities, pool, field, text);
    if (status)
        document.commit();
    else
        document.cancel();
    return status;
}

Status edit_setting(Document& document, std::string_view name, std::string_view value) {
    document.begin("Set " + readable(name));
    Status status = document.set_setting(name, value);
    if (status)
        document.commit();
    else
        document.cancel();
    return status;
}

std::optional<Placed> place_of(Document& document, Entity entity) {
    ecs::Registry& registry = document.registry();
    if (!registry.alive(entity) || !registry.has<scene::Transform>(entity))
        return std::nullopt;
    Placed placed{world_of(document, entity), {}};
    const auto* instance = registry.try_get<scene::MeshInstance>(entity);
    if (instance != nullptr && instance->mesh < document.meshes().size())
        placed.bounds = document.meshes().bounds(instance->mesh);
    return placed;
}

bool is_power(const Field& field) {
    return field.kind == FieldKind::vector3 && field.unit.starts_with("W");
}

bool emits(Document& document, Entity entity) {
    for (const ecs::PoolBase* pool : document.registry().described_pools())
        if (pool->contains(entity) && pool->description() != &scene::LightSensor::description()) // which takes light
            for (const Field& field : pool->description()->fields) {
                if (!is_power(field))
                    continue;
                const auto* value = static_cast<const char*>(pool->address(pool->position_of(entity.index)));
                if (*reinterpret_cast<const vec3*>(value + field.offset) != vec3(0.0f))
                    return true;
            }
    return false;
}

Entities without_geometry(Document& document) {
    Entities result;
    ecs::Registry& registry = document.registry();
    registry.view<scene::Transform>().each([&](Entity entity, const scene::Transform&) {
        if (document.exists(entity) && !registry.has<scene::MeshInstance>(entity))
            result.push_back(entity);
    });
    return result;
}

Bounds bounds_of(Document& document, const Entities& entities) {
    Bounds result;
    ecs::Registry& registry = document.registry();
    for (const Entity top : entities)
        for (const Entity entity : document.family(top)) {
            const auto* instance = registry.try_get<scene::MeshInstance>(entity);
            if (instance != nullptr && instance->mesh < document.meshes().size())
                result.add(transform_bounds(world_of(document, entity), document.meshes().bounds(instance->mesh)));
            else if (registry.has<scene::Transform>(entity))
                result.add(vec3(world_of(document, entity)[3]));
        }
    return result;
}

Bounds bounds_of_all(Document& document) {
    Bounds result;
    document.registry().view<scene::MeshInstance>().each([&](Entity entity, const scene::MeshInstance& instance) {
        if (instance.mesh < document.meshes().size())
            result.add(transform_bounds(world_of(document, entity), document.meshes().bounds(instance.mesh)));
    });
    return result;
}

} // namespace sunfleck::editor

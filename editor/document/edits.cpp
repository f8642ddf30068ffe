#include "editor/document/edits.h"

#include "engine/scene/entity_names.h"

#include <algorithm>

namespace sunfleck::editor {
namespace {

template <typename T>
void put(Document& document, Entity entity, T value) {
    document.set(entity, pool_of<T>(document), std::make_shared<T>(std::move(value)));
}

// The nearest translation, rotation and scale.
scene::Transform transform_of(const mat4& m) {
    scene::Transform result;
    result.position = vec3(m[3]);
    result.scale = vec3(glm::length(vec3(m[0])), glm::length(vec3(m[1])), glm::length(vec3(m[2])));
    if (glm::determinant(mat3(m)) < 0.0f)
        result.scale.x = -result.scale.x;
    mat3 turn(1.0f);
    for (int i = 0; i < 3; ++i)
        if (result.scale[i] != 0.0f)
            turn[i] = vec3(m[i]) / result.scale[i];
    const quat rotation = glm::quat_cast(turn);
    const float length = glm::length(rotation);
    result.rotation = length > 1e-6f ? rotation / length : quat(1.0f, 0.0f, 0.0f, 0.0f);
    return result;
}

bool is_usable(const scene::Transform& transform) {
    return static_cast<bool>(validate(scene::Transform::description(), &transform));
}

// Handles in described fields that point into `copies` point to the copies.
void retarget(const ecs::PoolBase& pool, void* value, const std::unordered_map<Entity, Entity>& copies) {
    if (pool.description() == nullptr)
        return;
    for (const Field& field : pool.description()->fields)
        if (field.kind == FieldKind::entity) {
            auto* target = reinterpret_cast<Entity*>(static_cast<char*>(value) + field.offset);
            if (const auto found = copies.find(*target); found != copies.end())
                *target = found->second;
        }
}

using OtherNames = std::vector<std::pair<std::string, std::string>>; // before, after

bool names_entities(const Field& field) {
    return field.kind == FieldKind::text && (field.flags & scene::names_entities) != 0;
}
bool names_entities(const ecs::PoolBase& pool) {
    return pool.description() != nullptr &&
           std::any_of(pool.description()->fields.begin(), pool.description()->fields.end(),
                       [](const Field& field) { return names_entities(field); });
}

// Names of entities in described texts follow those of the list; whether any did.
bool rename_in(const ecs::PoolBase& pool, void* value, const OtherNames& names) {
    bool any = false;
    if (!names_entities(pool))
        return any;
    for (const Field& field : pool.description()->fields) {
        if (!names_entities(field))
            continue;
        auto& text = *reinterpret_cast<std::string*>(static_cast<char*>(value) + field.offset);
        const std::vector<std::string> named = scene::split_names(text);
        for (const auto& [before, after] : names)
            if (std::find(named.begin(), named.end(), before) != named.end()) {
                text = scene::with_other_name(text, before, after);
                any = true;
            }
    }
    return any;
}

// Of what entities have in this document, and files keep.
std::vector<ecs::PoolBase*> kept_pools(Document& document) {
    std::vector<ecs::PoolBase*> result;
    for (ecs::PoolBase* pool : document.registry().all_pools())
        if (pool->size() > 0 && pool->is_copyable() && !pool->is_derived())
            result.push_back(pool);
    return result;
}

} // namespace

std::string what(const Document& document, const Entities& entities) {
    return entities.size() == 1 ? document.name(entities[0]) : std::to_string(entities.size()) + " entities";
}

Entities topmost(const Document& document, const Entities& entities) {
    std::vector<bool> given; // by index
    for (const Entity entity : entities) {
        if (!document.exists(entity))
            continue;
        if (entity.index >= given.size())
            given.resize(entity.index + 1);
        given[entity.index] = true;
    }
    const auto is_given = [&](Entity entity) { return entity.index < given.size() && given[entity.index]; };
    Entities result;
    for (const Entity entity : entities) {
        std::size_t depth = 0;
        Entity above = document.parent(entity);
        while (!above.is_null() && !is_given(above) && ++depth < document.entity_count())
            above = document.parent(above);
        if (above.is_null() || !is_given(above))
            result.push_back(entity);
    }
    return result;
}

void remove(Document& document, const Entities& entities) {
    if (entities.empty())
        return;
    document.begin("Delete " + what(document, entities));
    // First who, then away with them: the tree is found again after each change.
    Entities all;
    for (const Entity top : topmost(document, entities)) {
        const Entities family = document.family(top);
        all.insert(all.end(), family.begin(), family.end());
    }
    for (ecs::PoolBase* pool : kept_pools(document))
        for (auto entity = all.rbegin(); entity != all.rend(); ++entity)
            if (pool->contains(*entity))
                document.set(*entity, *pool, nullptr);
    document.select({});
    document.commit();
}

Entities duplicate(Document& document, const Entities& entities) {
    if (entities.empty())
        return {};
    document.begin("Duplicate " + what(document, entities));
    std::unordered_map<Entity, Entity> copies;
    Entities all, tops;
    for (const Entity top : topmost(document, entities))
        for (const Entity entity : document.family(top)) {
            copies[entity] = document.create();
            all.push_back(entity);
            if (entity == top)
                tops.push_back(copies[entity]);
        }
    OtherNames names;
    for (const Entity entity : all) {
        names.emplace_back(document.name(entity), document.free_name(document.name(entity)));
        put(document, copies[entity], scene::Name{names.back().second});
    }
    const std::vector<ecs::PoolBase*> pools = kept_pools(document);
    for (const Entity entity : all)
        for (ecs::PoolBase* pool : pools) {
            if (!pool->contains(entity) || pool == &pool_of<scene::Name>(document))
                continue;
            const std::shared_ptr<void> value = pool->copy_value(pool->address(pool->position_of(entity.index)));
            retarget(*pool, value.get(), copies);
            rename_in(*pool, value.get(), names);
            document.set(copies[entity], *pool, value);
        }
    document.select(tops);
    document.commit();
    return tops;
}

void set_world(Document& document, Entity entity, const mat4& world) {
    const Entity above = document.parent(entity);
    const mat4 outer = above.is_null() ? mat4(1.0f) : world_of(document, above);
    if (std::abs(glm::determinant(outer)) < 1e-30f || !document.registry().has<scene::Transform>(entity))
        return;
    const scene::Transform local = transform_of(glm::inverse(outer) * world);
    if (is_usable(local))
        put(document, entity, local);
}

Status reparent(Document& document, const Entities& entities, Entity parent) {
    if (entities.empty())
        return {};
    for (const Entity entity : entities)
        if (!parent.is_null() && document.is_below(parent, entity))
            return Error{"'" + document.name(entity) + "' cannot go under '" + document.name(parent) +
                         "', which is itself or below it"};
    document.begin("Move " + what(document, entities) + " in the tree");
    for (const Entity entity : topmost(document, entities)) {
        const mat4 world = world_of(document, entity);
        if (parent.is_null())
            document.set(entity, pool_of<scene::Parent>(document), nullptr);
        else
            put(document, entity, scene::Parent{parent});
        set_world(document, entity, world);
    }
    document.commit();
    return {};
}

Entity group(Document& document, const Entities& entities) {
    if (entities.empty())
        return ecs::null_entity;
    const Entities tops = topmost(document, entities);
    document.begin("Group " + what(document, entities));
    vec3 middle(0.0f);
    for (const Entity entity : tops)
        middle += vec3(world_of(document, entity)[3]) / float(tops.size());
    const Entity result = document.create();
    const Entity above = document.parent(tops[0]);
    put(document, result, scene::Name{document.free_name("group")});
    if (!above.is_null() &&
        std::none_of(tops.begin(), tops.end(), [&](Entity e) { return document.is_below(above, e); }))
        put(document, result, scene::Parent{above});
    put(document, result, scene::Transform{});
    set_world(document, result, glm::translate(mat4(1.0f), middle));
    for (const Entity entity : tops) {
        const mat4 world = world_of(document, entity);
        put(document, entity, scene::Parent{result});
        set_world(document, entity, world);
    }
    document.select({result});
    document.commit();
    return result;
}

Status rename(Document& document, Entity entity, const std::string& wanted) {
    if (wanted.find_first_not_of(" \t\r\n") == std::string::npos)
        return Error{"a name must not be empty"};
    if (wanted == document.name(entity))
        return {};
    document.begin("Rename " + document.name(entity));
    const std::string before = document.name(entity);
    put(document, entity, scene::Name{""}); // its own name is free, too
    put(document, entity, scene::Name{document.free_name(wanted)});
    const OtherNames names = {{before, document.name(entity)}};
    for (ecs::PoolBase* pool : kept_pools(document)) {
        if (!names_entities(*pool))
            continue;
        const std::vector<Entity> users = pool->entities();
        for (const Entity user : users) {
            const std::shared_ptr<void> value = pool->copy_value(pool->address(pool->position_of(user.index)));
            if (rename_in(*pool, value.get(), names))
                document.set(user, *pool, value);
        }
    }
    document.commit();
    return {};
}

Entity add_from(Document& document, const scene::EntityTemplate& source, vec3 position, float size) {
    document.begin("Add " + std::string(source.name));
    ecs::Registry scratch;
    scene::MeshStore meshes;
    const Entity made = scratch.create();
    source.make(scratch, made, meshes, size);
    scratch.patch<scene::Transform>(made, [&](scene::Transform& transform) { transform.position = position; });
    std::string name(source.name);
    name[0] = char(std::tolower(name[0]));
    std::unordered_map<Entity, Entity> copies; // of the template's entity and its parts
    for (const Entity part : scratch.entities())
        copies[part] = document.create();
    name = document.free_name(name);
    for (const Entity part : scratch.entities()) {
        if (scene::MeshInstance const* instance = scratch.try_get<scene::MeshInstance>(part)) {
            const std::uint32_t mesh = document.add_shape(meshes[instance->mesh]);
            scratch.patch<scene::MeshInstance>(part, [&](scene::MeshInstance& value) { value.mesh = mesh; });
        }
        const scene::Name* of_part = scratch.try_get<scene::Name>(part);
        put(document, copies[part],
            scene::Name{of_part != nullptr ? document.free_name(name + " " + of_part->name) : name});
        for (const ecs::PoolBase* pool : scratch.all_pools()) {
            if (!pool->contains(part) || pool->type_index == pool_of<scene::Name>(document).type_index)
                continue;
            const std::shared_ptr<void> value = pool->copy_value(pool->address(pool->position_of(part.index)));
            retarget(*pool, value.get(), copies);
            document.set(copies[part], document.registry().counterpart(*pool), value);
        }
    }
    document.select({copies[made]});
    document.commit();
    return copies[made];
}

} // namespace sunfleck::editor

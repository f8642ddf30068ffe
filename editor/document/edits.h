// What users do to a document, each one gesture. None knows a component but the few that make a tree of entities.
#pragma once

#include "editor/document/document.h"
#include "editor/document/played_places.h"
#include "engine/scene/entity_templates.h"

namespace sunfleck::editor {

// Without entities, these do nothing.
using Entities = std::vector<Entity>;

// "lamp", "3 entities".
std::string what(const Document& document, const Entities& entities);

// With all that is below them.
void remove(Document& document, const Entities& entities);
// Beside the originals, with all that is below them; the copies are selected. Where a copy names an entity that was
// copied, too, it names that copy.
Entities duplicate(Document& document, const Entities& entities);
// Their places in the world stay. Null: to the top. An error if the parent is among them or below.
Status reparent(Document& document, const Entities& entities, Entity parent);
// Puts them under a new entity, at their middle.
Entity group(Document& document, const Entities& entities);
// The name is made distinct and free of control characters; an error if it is empty. Texts that name the entity
// follow.
Status rename(Document& document, Entity entity, const std::string& wanted);
// At `transform`'s position; `size`: of the template, m.
Entity add_from(Document& document, const scene::EntityTemplate& source, vec3 position, float size);
void add_component(Document& document, const Entities& entities, ecs::PoolBase& pool);
void remove_component(Document& document, const Entities& entities, ecs::PoolBase& pool);
// Replaces or adds the component.
void paste_component(Document& document, const Entities& entities, ecs::PoolBase& pool, const ecs::Value& value);

// Within a gesture: sets one field, from text, of all that have the component. An error (range, not a number) leaves
// everything as it was.
Status set_field(Document& document, const Entities& entities, ecs::PoolBase& pool, const Field& field,
                 std::string_view text);
// The same as a gesture of its own.
Status edit_field(Document& document, const Entities& entities, ecs::PoolBase& pool, const Field& field,
                  std::string_view text);
// Settings likewise.
Status edit_setting(Document& document, std::string_view name, std::string_view value);

// The entity's place in the world, computed from the document.
inline mat4 world_of(Document& document, Entity entity) {
    return scene::world_matrix(document.registry(), entity);
}
// The same where a scene in motion has it; as edited where `played` is null or does not know the entity.
inline mat4 world_of(Document& document, Entity entity, const PlayedPlaces* played) {
    const mat4* place = played != nullptr ? played->find(entity) : nullptr;
    return place != nullptr ? *place : world_of(document, entity);
}
// Within a gesture: gives an entity this place in the world, whatever is above it. Without a Transform it stays.
void set_world(Document& document, Entity entity, const mat4& world);
// Entities that have no ancestor among `entities`.
Entities topmost(const Document& document, const Entities& entities);
// Where an entity is, and its geometry, if it has any, before it is put there.
struct Placed {
    mat4 world{1.0f};
    Bounds bounds; // empty: it has no geometry
};
// None: it has no place.
std::optional<Placed> place_of(Document& document, Entity entity);
// Of light: radiance, intensity, irradiance.
bool is_power(const Field& field);
// Whether one of its components has a power of light that is not zero.
bool emits(Document& document, Entity entity);
// Those that have a place, but nothing that could be seen there.
Entities without_geometry(Document& document);
// Of everything that has geometry, in the world.
Bounds bounds_of(Document& document, const Entities& entities);
Bounds bounds_of_all(Document& document);

// Components that make entities a tree with names, or refer to geometry by number: rename, reparent and others change
// them, so that names stay distinct and numbers mean something; fields of theirs are not edited one by one.
bool is_part_of_tree(Document& document, const ecs::PoolBase& pool);

// The component's pool in the document by type.
template <typename T>
ecs::PoolBase& pool_of(Document& document) {
    return *find_component(document, T::description().name);
}

} // namespace sunfleck::editor

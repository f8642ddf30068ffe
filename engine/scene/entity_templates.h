// Entities that people add to a scene: what an editor offers under "Add".
#pragma once

#include "engine/scene/components.h"
#include "engine/scene/mesh_store.h"

#include <span>

namespace sunfleck::scene {

struct EntityTemplate {
    std::string_view name; // "Point light"
    std::string_view tooltip;
    std::string_view group; // heading in menus
    // Gives `entity`, which has nothing yet, its components, a Transform among them; geometry goes to `meshes`. What it
    // is made of, if it has parts, are other entities below it, with names of their own. `size`: m, of something that
    // one sees well in the scene, for example a fifth of a room's height; light reaches some sizes far.
    void (*make)(ecs::Registry& registry, ecs::Entity entity, MeshStore& meshes, float size);
};

// In the order in which they are offered; those of one group follow one another.
std::span<const EntityTemplate> entity_templates();

// Whether a change from `before` to `now` asks for another mesh.
bool needs_other_mesh(const AreaLight& before, const AreaLight& now);

} // namespace sunfleck::scene

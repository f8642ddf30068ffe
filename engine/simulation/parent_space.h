// What has parents: who it is part of, and its place in the world, which without a parent is exactly as it is stored.
#pragma once

#include "engine/scene/components.h"

namespace sunfleck::simulation {

// The entity itself or the nearest ancestor that has the component; null: none has.
template <typename T>
ecs::Entity owner_of(const ecs::Registry& registry, ecs::Entity entity) {
    constexpr int deepest = 1000; // parents may form a ring
    for (int depth = 0; depth < deepest && registry.alive(entity); ++depth) {
        if (registry.has<T>(entity))
            return entity;
        const auto* parent = registry.try_get<scene::Parent>(entity);
        if (parent == nullptr)
            break;
        entity = parent->parent;
    }
    return ecs::null_entity;
}

// What is relative to the entity's parent, in the world.
mat4 in_world(const ecs::Registry& registry, ecs::Entity entity, const scene::Transform& transform);
vec3 from_parent(const ecs::Registry& registry, ecs::Entity entity, vec3 position);
// The entity's Transform, of its present scale, where it has this place and turn in the world.
scene::Transform transform_at(const ecs::Registry& registry, ecs::Entity entity, vec3 position, const quat& rotation);

} // namespace sunfleck::simulation

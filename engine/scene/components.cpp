#include "engine/scene/components.h"

#include <cstring>

namespace sunfleck::scene {
namespace {
// A hierarchy deeper than this is treated as a cycle.
constexpr int depth_limit = 1000;
} // namespace

bool is_static(const ecs::Registry& registry, ecs::Entity entity) {
    for (int depth = 0; depth < depth_limit && registry.alive(entity); ++depth) {
        if (registry.has<Mover>(entity))
            return false;
        const Parent* parent = registry.try_get<Parent>(entity);
        if (parent == nullptr)
            break;
        entity = parent->parent;
    }
    return true;
}

mat4 world_matrix(const ecs::Registry& registry, ecs::Entity entity) {
    mat4 matrix(1.0f);
    for (int depth = 0; depth < depth_limit && registry.alive(entity); ++depth) {
        if (const Transform* transform = registry.try_get<Transform>(entity))
            matrix = transform->matrix() * matrix;
        const Parent* parent = registry.try_get<Parent>(entity);
        if (parent == nullptr)
            break;
        entity = parent->parent;
    }
    return matrix;
}

void update_world_transforms(ecs::Registry& registry) {
    std::vector<std::pair<ecs::Entity, mat4>> changed;
    registry.view<Transform>().each([&](ecs::Entity entity, const Transform&) {
        const mat4 matrix = world_matrix(registry, entity);
        const WorldTransform* stored = registry.try_get<WorldTransform>(entity);
        // By their bits: which zeros are negative must not depend on what was there before.
        if (stored == nullptr || std::memcmp(&stored->matrix, &matrix, sizeof matrix) != 0)
            changed.emplace_back(entity, matrix);
    });
    for (const auto& [entity, matrix] : changed)
        registry.emplace_or_replace<WorldTransform>(entity, {matrix});
}

ecs::Entity find_by_name(ecs::Registry& registry, std::string_view name) {
    ecs::Entity found;
    registry.view<Name>().each([&](ecs::Entity entity, const Name& label) {
        if (label.name == name && entity.index < found.index)
            found = entity;
    });
    return found;
}

} // namespace sunfleck::scene

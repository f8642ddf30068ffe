#include "engine/simulation/parent_space.h"

#include <algorithm>

namespace sunfleck::simulation {
namespace {

// Of a matrix without shear.
quat rotation_of(const mat4& matrix) {
    mat3 axes(matrix);
    for (int i = 0; i < 3; ++i)
        axes[i] /= std::max(glm::length(axes[i]), 1e-20f);
    return glm::normalize(glm::quat_cast(axes));
}

mat4 parent_matrix(const ecs::Registry& registry, ecs::Entity entity) {
    const auto* parent = registry.try_get<scene::Parent>(entity);
    return parent != nullptr && registry.alive(parent->parent) ? scene::world_matrix(registry, parent->parent)
                                                               : mat4(1.0f);
}

} // namespace

mat4 in_world(const ecs::Registry& registry, ecs::Entity entity, const scene::Transform& transform) {
    const mat4 matrix = transform.matrix();
    return registry.has<scene::Parent>(entity) ? parent_matrix(registry, entity) * matrix : matrix;
}

vec3 from_parent(const ecs::Registry& registry, ecs::Entity entity, vec3 position) {
    return registry.has<scene::Parent>(entity) ? vec3(parent_matrix(registry, entity) * vec4(position, 1.0f))
                                               : position;
}

scene::Transform transform_at(const ecs::Registry& registry, ecs::Entity entity, vec3 position, const quat& rotation) {
    scene::Transform result = registry.get<scene::Transform>(entity);
    result.position = position;
    result.rotation = rotation;
    if (!registry.has<scene::Parent>(entity))
        return result;
    const mat4 parent = parent_matrix(registry, entity);
    if (glm::determinant(mat3(parent)) == 0.0f) // flat: there is no such place
        return registry.get<scene::Transform>(entity);
    result.position = vec3(glm::inverse(parent) * vec4(position, 1.0f));
    result.rotation = glm::normalize(glm::inverse(rotation_of(parent)) * rotation);
    return result;
}

} // namespace sunfleck::simulation

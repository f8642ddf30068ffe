#include "editor/document/picking.h"

#include "editor/document/edits.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sunfleck::editor {
namespace {

bool meets(const Bounds& bounds, vec3 origin, vec3 direction, float nearest) {
    float begin = 0.0f, end = nearest;
    for (int axis = 0; axis < 3; ++axis) {
        const float to_low = bounds.minimum[axis] - origin[axis], to_high = bounds.maximum[axis] - origin[axis];
        if (direction[axis] == 0.0f) {
            if (to_low > 0.0f || to_high < 0.0f)
                return false;
            continue;
        }
        const float a = to_low / direction[axis], b = to_high / direction[axis];
        begin = std::max(begin, std::min(a, b));
        end = std::min(end, std::max(a, b));
    }
    return begin <= end;
}

// T. Moeller and B. Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", 1997; both sides.
float triangle_distance(const vec3 (&corner)[3], vec3 origin, vec3 direction) {
    constexpr float none = std::numeric_limits<float>::infinity();
    const vec3 a = corner[1] - corner[0], b = corner[2] - corner[0], p = glm::cross(direction, b);
    const float determinant = glm::dot(a, p);
    if (determinant == 0.0f)
        return none;
    const vec3 t = origin - corner[0], q = glm::cross(t, a);
    const float u = glm::dot(t, p) / determinant, v = glm::dot(direction, q) / determinant;
    const float distance = glm::dot(b, q) / determinant;
    return u >= 0.0f && v >= 0.0f && u + v <= 1.0f && distance > 0.0f ? distance : none;
}

} // namespace

Picked pick(Document& document, vec3 origin, vec3 direction, const std::function<bool(Entity)>& skip,
            const PlayedPlaces* played) {
    Picked nearest;
    nearest.distance = std::numeric_limits<float>::infinity();
    const auto look_at = [&](Entity entity, const scene::MeshInstance& instance) {
        if (instance.mesh >= document.meshes().size() || (skip && skip(entity)))
            return;
        const mat4 world = world_of(document, entity, played);
        if (!meets(transform_bounds(world, document.meshes().bounds(instance.mesh)), origin, direction,
                   nearest.distance))
            return;
        const mat4 to_local = glm::inverse(world);
        const vec3 from(to_local * vec4(origin, 1.0f)), along = mat3(to_local) * direction;
        const scene::Mesh& mesh = document.meshes()[instance.mesh];
        for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
            const vec3 corners[3] = {mesh.positions[mesh.indices[i]], mesh.positions[mesh.indices[i + 1]],
                                     mesh.positions[mesh.indices[i + 2]]};
            const float distance = triangle_distance(corners, from, along);
            if (distance < nearest.distance)
                nearest = {entity, distance};
        }
    };
    document.registry().view<scene::MeshInstance>().each(look_at);
    return nearest.entity.is_null() ? Picked() : nearest;
}

} // namespace sunfleck::editor

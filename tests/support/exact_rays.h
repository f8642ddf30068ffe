// Whether a segment meets triangles, in double precision and over its whole length: slow, and independent of both
// Embree and the visibility database.
#pragma once

#include "engine/ecs/registry.h"
#include "engine/scene/components.h"
#include "engine/scene/mesh_store.h"
#include "gi_module/visibility/convex.h"

namespace sunfleck::gi {

class ExactRays {
public:
    ExactRays(ecs::Registry& registry, const scene::MeshStore& meshes) {
        registry.view<scene::MeshInstance, scene::WorldTransform>().each(
            [&](ecs::Entity, const scene::MeshInstance& instance, const scene::WorldTransform& world) {
                const scene::Mesh& mesh = meshes[instance.mesh];
                triangles_.reserve(triangles_.size() + mesh.indices.size() / 3);
                const auto corner = [&](std::size_t i) { // where rounding puts it: meshes are drawn in single precision
                    return dvec3(vec3(world.matrix * vec4(mesh.positions[mesh.indices[i]], 1.0f)));
                };
                for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
                    add(corner(i), corner(i + 1), corner(i + 2));
            });
    }

    // From `point` on a surface with the normal `normal` to `light`, both ends included. Left out are triangles in the
    // plane of that surface. Triangles are open where `margin` (of the triangle's size) is above 0: grazing them is not
    // meeting them; below 0 they are closed, and the point's end reaches as far beyond it.
    bool meets(dvec3 light, dvec3 point, dvec3 normal, double margin) const {
        const dvec3 along = light - point;
        for (const Triangle& triangle : triangles_) {
            const double slope = glm::dot(triangle.normal, along);
            if (std::abs(slope) <= 1e-14 * glm::length(along))
                continue;
            const double height = glm::dot(triangle.normal, triangle.corners[0] - point), t = height / slope;
            if (t < margin || t > 1.0 - std::abs(margin) || !contains(triangle, point + t * along, margin))
                continue;
            if (std::abs(glm::dot(triangle.normal, normal)) < 1.0 - 1e-9 || std::abs(height) > 1e-6)
                return true;
        }
        return false;
    }

private:
    struct Triangle {
        dvec3 corners[3];
        dvec3 normal;
    };
    void add(dvec3 a, dvec3 b, dvec3 c) {
        const dvec3 area = glm::cross(b - a, c - a);
        if (glm::length(area) > 0.0)
            triangles_.push_back({{a, b, c}, glm::normalize(area)});
    }
    static bool contains(const Triangle& triangle, dvec3 point, double margin) {
        for (int i = 0; i < 3; ++i) {
            const dvec3 a = triangle.corners[i], edge = triangle.corners[(i + 1) % 3] - a;
            const double inside = glm::dot(glm::cross(triangle.normal, edge), point - a);
            if (inside < margin * glm::dot(edge, edge))
                return false;
        }
        return true;
    }
    std::vector<Triangle> triangles_;
};

} // namespace sunfleck::gi

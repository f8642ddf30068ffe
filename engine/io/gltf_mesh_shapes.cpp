#include "engine/io/gltf_mesh_shapes.h"

#include "engine/scene/procedural.h"

#include <cmath>
#include <numeric>

namespace sunfleck::io {
namespace {

constexpr std::size_t max_thin_bodies = 500000;              // a primitive
constexpr float relative_radius = 1e-3f, min_radius = 1e-4f; // of the mesh's diagonal; m
constexpr int mode_points = 0, mode_lines = 1, mode_line_loop = 2;

template <typename T>
void gather(std::vector<T>& values, const std::vector<std::uint32_t>& order, std::size_t width = 1) {
    if (values.empty())
        return;
    std::vector<T> result;
    result.reserve(order.size() * width);
    for (const std::uint32_t index : order)
        result.insert(result.end(), values.begin() + std::ptrdiff_t(index * width),
                      values.begin() + std::ptrdiff_t((index + 1) * width));
    values = std::move(result);
}

// Gathers vertices in the given order, with all attributes except normals.
void gather_vertices(scene::DeformableMesh& mesh, const std::vector<std::uint32_t> order) {
    gather(mesh.rest.positions, order);
    gather(mesh.rest.texture_coordinates, order);
    gather(mesh.rest.tangents, order);
    gather(mesh.rest.colours, order);
    for (scene::MorphTarget& target : mesh.targets) {
        gather(target.positions, order);
        target.normals.clear();
    }
    gather(mesh.joints, order, mesh.influences);
    gather(mesh.weights, order, mesh.influences);
}

std::vector<std::pair<std::uint32_t, std::uint32_t>> segments_of(const std::vector<std::uint32_t>& indices, int mode) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> segments;
    const std::size_t step = mode == mode_lines ? 2 : 1;
    for (std::size_t i = 0; i + 1 < indices.size(); i += step)
        segments.emplace_back(indices[i], indices[i + 1]);
    if (mode == mode_line_loop && indices.size() > 2)
        segments.emplace_back(indices.back(), indices.front());
    return segments;
}

// The vertices of all bodies: a vertex of the mesh and an offset direction each.
struct Bodies {
    std::vector<std::uint32_t> order, triangles;
    std::vector<vec3> directions;

    void add_point(std::uint32_t vertex) {
        const auto first = std::uint32_t(order.size());
        for (int axis = 0; axis < 3; ++axis)
            for (const float sign : {1.0f, -1.0f}) {
                vec3 direction(0.0f);
                direction[axis] = sign;
                order.push_back(vertex);
                directions.push_back(direction);
            }
        for (std::uint32_t octant = 0; octant < 8; ++octant) {
            const std::uint32_t x = first + (octant & 1u), y = first + 2 + (octant >> 1 & 1u),
                                z = first + 4 + (octant >> 2 & 1u);
            const bool turned = ((octant & 1u) + (octant >> 1 & 1u) + (octant >> 2 & 1u)) % 2 != 0;
            triangles.insert(triangles.end(), {x, turned ? z : y, turned ? y : z});
        }
    }
    void add_segment(std::uint32_t a, std::uint32_t b, vec3 along) {
        const float length = glm::length(along);
        if (!(length > 0.0f))
            return add_point(a);
        vec3 tangent, bitangent;
        orthonormal_basis(along / length, tangent, bitangent);
        const auto first = std::uint32_t(order.size());
        for (const std::uint32_t end : {a, b})
            for (int corner = 0; corner < 3; ++corner) {
                const float angle = float(corner) * 2.0943951f;
                order.push_back(end);
                directions.push_back(std::cos(angle) * tangent + std::sin(angle) * bitangent);
            }
        for (std::uint32_t k = 0; k < 3; ++k) {
            const std::uint32_t p = first + k, q = first + (k + 1) % 3;
            triangles.insert(triangles.end(), {p, q, q + 3, p, q + 3, p + 3});
        }
        triangles.insert(triangles.end(), {first, first + 2, first + 1, first + 3, first + 4, first + 5});
    }
};

} // namespace

void make_flat(scene::DeformableMesh& mesh) {
    gather_vertices(mesh, mesh.rest.indices);
    std::iota(mesh.rest.indices.begin(), mesh.rest.indices.end(), 0u);
    scene::compute_normals(mesh.rest);
}

bool make_solid(scene::DeformableMesh& mesh, const std::vector<std::uint32_t>& indices, int mode) {
    mesh.rest.indices.clear();
    if (indices.size() > max_thin_bodies)
        return false;
    Bodies bodies;
    if (mode == mode_points)
        for (const std::uint32_t index : indices)
            bodies.add_point(index);
    else
        for (const auto& [a, b] : segments_of(indices, mode))
            bodies.add_segment(a, b, mesh.rest.positions[b] - mesh.rest.positions[a]);
    const float radius = std::max(relative_radius * glm::length(mesh.rest.bounds().extent()), min_radius);
    gather_vertices(mesh, bodies.order);
    for (std::size_t i = 0; i < bodies.directions.size(); ++i)
        mesh.rest.positions[i] += radius * bodies.directions[i];
    mesh.rest.normals = std::move(bodies.directions);
    mesh.rest.indices = std::move(bodies.triangles);
    return true;
}

} // namespace sunfleck::io

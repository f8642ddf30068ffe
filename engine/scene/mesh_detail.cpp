#include "engine/scene/mesh_detail.h"

#include <algorithm>
#include <cmath>
#include <meshoptimizer.h>
#include <numeric>

namespace sunfleck::scene {
namespace {

constexpr std::size_t min_mesh = 64, min_triangles = 24; // below these, fewer triangles gain nothing
constexpr std::size_t large_mesh = 300000;               // triangles

std::uint32_t count_vertices(const std::vector<std::uint32_t>& indices, std::size_t vertices) {
    std::vector<std::uint8_t> used(vertices, 0);
    for (const std::uint32_t index : indices)
        used[index] = 1;
    return std::uint32_t(std::count(used.begin(), used.end(), std::uint8_t(1)));
}

// The mesh's indices, with coincident vertices counted as one.
std::vector<std::uint32_t> join_vertices(const Mesh& mesh) {
    std::vector<std::uint32_t> result(mesh.indices.size());
    if (!result.empty())
        meshopt_generateShadowIndexBuffer(result.data(), mesh.indices.data(), mesh.indices.size(), &mesh.positions[0].x,
                                          mesh.positions.size(), sizeof(vec3), sizeof(vec3));
    return result;
}

bool has_paired_edges(const std::vector<std::uint32_t>& joined_indices) {
    std::vector<std::uint64_t> edges, reversed;
    for (std::size_t i = 0; i + 2 < joined_indices.size(); i += 3)
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint64_t a = joined_indices[i + k], b = joined_indices[i + (k + 1) % 3];
            if (a == b)
                continue; // degenerate triangle
            edges.push_back(a << 32 | b);
            reversed.push_back(b << 32 | a);
        }
    std::sort(edges.begin(), edges.end());
    std::sort(reversed.begin(), reversed.end());
    return !edges.empty() && edges == reversed && std::adjacent_find(edges.begin(), edges.end()) == edges.end();
}

// For each vertex, one that stands for all that triangles connect it with.
std::vector<std::uint32_t> connected_parts(const std::vector<std::uint32_t>& joined_indices, std::size_t vertices) {
    std::vector<std::uint32_t> part(vertices);
    std::iota(part.begin(), part.end(), 0u);
    const auto find = [&](std::uint32_t vertex) {
        while (part[vertex] != vertex)
            vertex = part[vertex] = part[part[vertex]];
        return vertex;
    };
    for (std::size_t i = 0; i + 2 < joined_indices.size(); i += 3)
        for (std::size_t k = 1; k < 3; ++k)
            part[find(joined_indices[i + k])] = find(joined_indices[i]);
    for (std::uint32_t vertex = 0; vertex < part.size(); ++vertex)
        part[vertex] = find(vertex);
    return part;
}

} // namespace

std::vector<MeshDetail> make_mesh_details(const Mesh& mesh, const std::function<bool(float)>& progress) {
    std::vector<MeshDetail> details(1);
    details.reserve(32); // keeps `whole` in place
    MeshDetail& whole = details.front();
    whole.indices = join_vertices(mesh);
    if (mesh.indices.empty())
        return details;
    const float* positions = &mesh.positions[0].x;
    whole.vertex_count = count_vertices(whole.indices, mesh.positions.size());
    const float scale = meshopt_simplifyScale(positions, mesh.positions.size(), sizeof(vec3));
    std::size_t target = whole.indices.size() / 6 * 3;
    while (details.size() < 32 && mesh.triangle_count() >= min_mesh && target / 3 >= min_triangles) {
        // Of a large mesh, each level takes about half as long as the one before.
        if (progress && mesh.triangle_count() > large_mesh && !progress(1.0f - std::exp2(1.0f - float(details.size()))))
            break;
        MeshDetail detail;
        detail.indices.resize(details.front().indices.size());
        float error = 0.0f;
        // Each level is simplified from the whole mesh, so that its error is relative to the original; of large meshes,
        // where that would take minutes, from the level before, and errors add up.
        const MeshDetail& from = mesh.triangle_count() > large_mesh ? details.back() : details.front();
        detail.indices.resize(meshopt_simplify(detail.indices.data(), from.indices.data(), from.indices.size(),
                                               positions, mesh.positions.size(), sizeof(vec3), target, 0.25f, 0,
                                               &error));
        if (detail.indices.size() * 10 > details.back().indices.size() * 9 || detail.indices.empty())
            break;
        detail.error = from.error + error * scale;
        detail.vertex_count = count_vertices(detail.indices, mesh.positions.size());
        details.push_back(std::move(detail));
        target = target / 6 * 3;
    }
    return details;
}

bool is_closed(const Mesh& mesh) {
    return has_paired_edges(join_vertices(mesh));
}

bool is_solid(const std::vector<std::uint32_t>& joined_indices, const std::vector<vec3>& positions) {
    if (!has_paired_edges(joined_indices))
        return false;
    const std::vector<std::uint32_t> parts = connected_parts(joined_indices, positions.size());
    std::vector<double> volumes(positions.size(), 0.0); // six times that of a part, at the vertex that stands for it
    for (std::size_t i = 0; i + 2 < joined_indices.size(); i += 3) {
        const std::uint32_t part = parts[joined_indices[i]];
        const auto from_part = [&](std::size_t k) {
            return glm::dvec3(positions[joined_indices[k]]) - glm::dvec3(positions[part]);
        };
        volumes[part] += glm::dot(from_part(i), glm::cross(from_part(i + 1), from_part(i + 2)));
    }
    return std::all_of(joined_indices.begin(), joined_indices.end(),
                       [&](std::uint32_t index) { return volumes[parts[index]] > 0.0; });
}

} // namespace sunfleck::scene

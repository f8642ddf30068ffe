// Flat connected pieces of a mesh: what patches and blocking polygons are made from.
#pragma once

#include "engine/scene/mesh_store.h"
#include "gi_module/visibility/convex.h"

namespace sunfleck::gi {

struct PlanarFace {
    dvec3 normal{0.0};
    std::uint32_t first = 0, count = 0; // of its triangles, in FlatMesh::by_face
    double area = 0.0;
};

struct FlatMesh {
    std::vector<dvec3> positions; // transformed
    std::vector<std::uint32_t> indices;
    std::vector<PlanarFace> faces;      // in order of their first triangle
    std::vector<std::uint32_t> by_face; // triangles, face by face: numbers within the mesh
    bool closed = false;                // every edge has two triangles, once in each direction
    double area = 0.0;

    std::span<const std::uint32_t> triangles(const PlanarFace& face) const {
        return {by_face.data() + face.first, face.count};
    }
    dvec3 corner(std::uint32_t triangle, int k) const { return positions[indices[triangle * 3 + std::uint32_t(k)]]; }
};

// Vertices at one place count as one. Triangles without area belong to no face.
FlatMesh find_planar_faces(const scene::Mesh& mesh, const mat4& matrix);

// The face as convex polygons: one if its outline is convex (whatever its triangles are), else its triangles.
std::vector<Polygon> convex_pieces(const FlatMesh& mesh, const PlanarFace& face);

} // namespace sunfleck::gi

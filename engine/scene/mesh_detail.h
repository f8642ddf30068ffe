// The same surface with fewer triangles, for uses that cannot tell the difference (shadow maps).
#pragma once

#include "engine/scene/mesh_store.h"

namespace sunfleck::scene {

struct MeshDetail {
    std::vector<std::uint32_t> indices; // into the mesh's own vertices
    std::uint32_t vertex_count = 0;     // different vertices among them
    float error = 0.0f;                 // m, in the mesh's space: how far the surface may be from the original
};

// From fine to coarse, each with about half the triangles of the one before; the first is the whole mesh with vertices
// at one place joined. Small meshes and such that cannot be simplified give the first alone.
std::vector<MeshDetail> make_mesh_details(const Mesh& mesh);

// Every edge has two triangles, once in each direction (vertices at one place count as one): there is an inside, and
// whoever looks from outside sees front faces only.
bool is_closed(const std::vector<std::uint32_t>& joined_indices);

} // namespace sunfleck::scene

// Levels of detail: simplified meshes, for uses where the difference does not show (shadow maps).
#pragma once

#include "engine/scene/mesh_store.h"

#include <functional>

namespace sunfleck::scene {

struct MeshDetail {
    std::vector<std::uint32_t> indices; // into the mesh's own vertices
    std::uint32_t vertex_count = 0;     // distinct vertices among them
    float error = 0.0f;                 // m, in the mesh's space: greatest deviation from the original surface
};

// From fine to coarse, each with about half the triangles of the previous one; the first is the whole mesh with
// coincident vertices merged. Small meshes and meshes that cannot be simplified have only the first. `progress` is
// called before each level of a large mesh, with the share that is done; the list ends where it returns false.
std::vector<MeshDetail> make_mesh_details(const Mesh& mesh, const std::function<bool(float)>& progress = {});

// Watertight: every edge has two triangles, once in each direction (coincident vertices count as one).
bool is_closed(const Mesh& mesh);

// Closed, and each of its connected parts has its front faces outside: who is outside sees only these.
// `joined_indices`: as of the first level of detail.
bool is_solid(const std::vector<std::uint32_t>& joined_indices, const std::vector<vec3>& positions);

} // namespace sunfleck::scene

// Triangle meshes, by index. Meshes are added and keep their triangles; vertices of deforming meshes are replaced, and
// a revision number tells consumers of derived data.
#pragma once

#include "engine/core/maths.h"

#include <cassert>
#include <string>
#include <vector>

namespace sunfleck::scene {

struct Mesh {
    std::string name;
    std::vector<vec3> positions;
    std::vector<vec3> normals; // one per vertex, unit length
    std::vector<std::uint32_t> indices;
    // One per vertex, or empty.
    std::vector<vec4> texture_coordinates; // xy: the first set, zw: the second
    std::vector<vec4> tangents;            // xyz: along increasing u, unit length; w: +1 or -1, sign of the bitangent
    std::vector<vec4> colours;             // linear RGBA, multiplies the base colour

    Bounds bounds() const {
        Bounds result;
        for (const vec3 position : positions)
            result.add(position);
        return result;
    }
    std::size_t triangle_count() const { return indices.size() / 3; }
    bool is_textured() const { return !texture_coordinates.empty() || !colours.empty(); }
};

class MeshStore {
public:
    std::uint32_t add(Mesh mesh) {
        bounds_.push_back(mesh.bounds());
        meshes_.push_back(std::move(mesh));
        revisions_.push_back(0);
        ++edits_;
        return std::uint32_t(meshes_.size() - 1);
    }
    // New vertices for the same triangles.
    void replace(std::uint32_t index, Mesh mesh) {
        assert(mesh.positions.size() == meshes_[index].positions.size() &&
               mesh.indices.size() == meshes_[index].indices.size());
        bounds_[index] = mesh.bounds();
        meshes_[index] = std::move(mesh);
        ++revisions_[index];
        ++edits_;
    }
    const Mesh& operator[](std::uint32_t index) const { return meshes_[index]; }
    const Bounds& bounds(std::uint32_t index) const { return bounds_[index]; }
    // How often the vertices were replaced.
    std::uint32_t revision(std::uint32_t index) const { return revisions_[index]; }
    // How often meshes were added or replaced.
    std::uint64_t edits() const { return edits_; }
    std::uint32_t size() const { return std::uint32_t(meshes_.size()); }

private:
    std::vector<Mesh> meshes_;
    std::vector<Bounds> bounds_;
    std::vector<std::uint32_t> revisions_;
    std::uint64_t edits_ = 0;
};

} // namespace sunfleck::scene

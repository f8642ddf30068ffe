// Triangle meshes, by index. Meshes are added and keep their triangles; vertices of deforming meshes are replaced, and
// a revision number tells consumers of derived data. A mesh that nothing refers to any more can be removed: it has no
// triangles then, and its index is not used again.
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
        entries_.push_back({std::move(mesh), {}, 0});
        entries_.back().bounds = entries_.back().mesh.bounds();
        ++edits_;
        return std::uint32_t(entries_.size() - 1);
    }
    void remove(std::uint32_t index) {
        entries_[index].mesh = {};
        entries_[index].bounds = {};
        ++removals_;
    }
    // New vertices for the same triangles.
    void replace(std::uint32_t index, Mesh mesh) {
        Entry& entry = entries_[index];
        assert(mesh.positions.size() == entry.mesh.positions.size() &&
               mesh.indices.size() == entry.mesh.indices.size());
        entry.bounds = mesh.bounds();
        entry.mesh = std::move(mesh);
        ++entry.revision;
        ++edits_;
    }
    const Mesh& operator[](std::uint32_t index) const { return entries_[index].mesh; }
    const Bounds& bounds(std::uint32_t index) const { return entries_[index].bounds; }
    // How often the vertices were replaced.
    std::uint32_t revision(std::uint32_t index) const { return entries_[index].revision; }
    // How often meshes were added or replaced.
    std::uint64_t edits() const { return edits_; }
    // How often meshes were removed.
    std::uint64_t removals() const { return removals_; }
    std::uint32_t size() const { return std::uint32_t(entries_.size()); }

private:
    struct Entry {
        Mesh mesh;
        Bounds bounds;
        std::uint32_t revision = 0;
    };
    std::vector<Entry> entries_;
    std::uint64_t edits_ = 0, removals_ = 0;
};

} // namespace sunfleck::scene

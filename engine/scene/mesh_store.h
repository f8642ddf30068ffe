// Triangle meshes, by index. Meshes are added and never change, so whoever has seen N of them has seen those for good.
#pragma once

#include "engine/core/maths.h"

#include <string>
#include <vector>

namespace sunfleck::scene {

struct Mesh {
    std::string name;
    std::vector<vec3> positions;
    std::vector<vec3> normals; // one a vertex, unit length
    std::vector<std::uint32_t> indices;
    Bounds bounds() const {
        Bounds result;
        for (const vec3 position : positions)
            result.add(position);
        return result;
    }
    std::size_t triangle_count() const { return indices.size() / 3; }
};

class MeshStore {
public:
    std::uint32_t add(Mesh mesh) {
        bounds_.push_back(mesh.bounds());
        meshes_.push_back(std::move(mesh));
        return std::uint32_t(meshes_.size() - 1);
    }
    const Mesh& operator[](std::uint32_t index) const { return meshes_[index]; }
    const Bounds& bounds(std::uint32_t index) const { return bounds_[index]; }
    std::uint32_t size() const { return std::uint32_t(meshes_.size()); }

private:
    std::vector<Mesh> meshes_;
    std::vector<Bounds> bounds_;
};

} // namespace sunfleck::scene

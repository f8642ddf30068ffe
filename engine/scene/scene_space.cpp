#include "engine/scene/scene_space.h"

#include <algorithm>
#include <cmath>

namespace sunfleck::scene {
namespace {

constexpr double least_chord = 2.7; // units

double area_of(const Mesh& mesh, const mat4& matrix) {
    double area = 0.0;
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        vec3 p[3];
        for (std::size_t k = 0; k < 3; ++k)
            p[k] = vec3(matrix * vec4(mesh.positions[mesh.indices[i + k]], 1.0f));
        area += 0.5 * double(glm::length(glm::cross(p[1] - p[0], p[2] - p[0])));
    }
    return area;
}

double nearest_power_of_two(double value) {
    return std::exp2(std::round(std::log2(value)));
}

// A sheet has no volume of its own: it counts as a tenth as thick as it is long.
double volume_of(const Bounds& bounds) {
    const vec3 extent = bounds.extent();
    const float least = 0.1f * std::max({extent.x, extent.y, extent.z});
    const glm::dvec3 sides(glm::max(extent, vec3(least)));
    return sides.x * sides.y * sides.z;
}

// Zero for scenes that reach to the world's origin or lie within some sixteen of their sizes of it; in steps that are
// so large that a scene seldom crosses one.
vec3 origin_of(const Bounds& bounds) {
    const vec3 extent = bounds.extent();
    const float step = 16.0f * float(nearest_power_of_two(double(std::max({extent.x, extent.y, extent.z}))));
    return glm::round(bounds.centre() / step) * step;
}

} // namespace

mat4 SceneSpace::place(const mat4& to_world) const {
    mat4 result = to_world;
    for (int c = 0; c < 3; ++c)
        result[c] = vec4(vec3(to_world[c]) / unit, to_world[c].w);
    result[3] = vec4(point(vec3(to_world[3])), to_world[3].w);
    return result;
}

CameraView SceneSpace::view(CameraView world) const {
    world.position = point(world.position);
    world.target = point(world.target);
    return world;
}

glm::dmat4 SceneSpace::to_clip(const glm::dmat4& world_to_clip) const {
    glm::dmat4 to_world(double(unit) * glm::dmat4(1.0));
    to_world[3] = glm::dvec4(glm::dvec3(origin), 1.0);
    return world_to_clip * to_world;
}

SceneSpace space_of(std::span<const PlacedMesh> geometry, const MeshStore& meshes) {
    Bounds bounds;
    double area = 0.0;
    for (const PlacedMesh& placed : geometry) {
        bounds.add(transform_bounds(placed.to_world, meshes.bounds(placed.mesh)));
        area += area_of(meshes[placed.mesh], placed.to_world);
    }
    SceneSpace space;
    if (bounds.empty() || !(area > 0.0) || !std::isfinite(area))
        return space;
    const double chord = 4.0 * volume_of(bounds) / area;
    if (!std::isfinite(chord) || !(chord > 1e-30))
        return space;
    space.unit = float(std::exp2(std::floor(std::log2(chord / least_chord))));
    space.origin = origin_of(bounds);
    return space;
}

} // namespace sunfleck::scene

// The space that a scene is lit in: the world, but for its unit of length and its origin, which follow from the static
// geometry. A room is a few units large in it and lies near its origin, whatever the world's unit and wherever in the
// world the room is; so a length that has to be small or large "for a scene" is a number there, and coordinates keep
// their precision. The unit is a power of two: scenes of metres that are as large as rooms are keep every bit.
#pragma once

#include "engine/scene/camera_view.h"
#include "engine/scene/mesh_store.h"

#include <span>

namespace sunfleck::scene {

struct SceneSpace {
    float unit = 1.0f; // m
    vec3 origin{0.0f}; // m, in the world
    bool operator==(const SceneSpace&) const = default;

    // From local coordinates to the world -> from local coordinates to this space.
    mat4 place(const mat4& to_world) const;
    vec3 point(vec3 world) const { return (world - origin) / unit; }
    CameraView view(CameraView world) const;
    // What leads from the world to clip space -> what leads there from this space.
    glm::dmat4 to_clip(const glm::dmat4& world_to_clip) const;
};

struct PlacedMesh {
    std::uint32_t mesh = 0;
    mat4 to_world{1.0f};
};

// The space of static geometry. Its unit is the power of two of which the mean chord of what the geometry encloses
// is 2.7 to 5.4: 4 V / S for a volume V within a surface S (Cauchy), with the volume of the box around all. So it is 1
// m for most rooms. The origin stays the world's, unless the scene lies so far away that floats there are coarser than
// in the scene. Without geometry: the world.
SceneSpace space_of(std::span<const PlacedMesh> geometry, const MeshStore& meshes);

} // namespace sunfleck::scene

// Composite meshes for furnishing scenes.
#pragma once

#include "assets/scene_builder.h"

namespace sunfleck::assets {

// Appends `part`, transformed, to `whole`.
void append(scene::Mesh& whole, const scene::Mesh& part, const mat4& transform);
// Appends a box given by its lowest and highest corner.
void append_box(scene::Mesh& whole, vec3 lowest, vec3 highest);

// A wall in the XY plane between x = 0 and `width`, from the ground to `height`, `depth` thick (z from 0), with a
// round-arched opening in its middle: `opening` wide, with the arch springing at height `springing`.
scene::Mesh make_arch(float width, float height, float depth, float opening, float springing, int segments);

// A standing figure of spheres and cylinders, `height` tall, its feet at the origin.
scene::Mesh make_figure(float height, int segments);

inline scene::Transform placed(vec3 position, float turn = 0.0f, float scale = 1.0f) {
    scene::Transform transform;
    transform.position = position;
    transform.rotation = glm::angleAxis(turn, vec3(0.0f, 1.0f, 0.0f));
    transform.scale = vec3(scale);
    return transform;
}

} // namespace sunfleck::assets

// Static geometry in boxes, coarsely: what may receive a light's shadow, and where.
#pragma once

#include "engine/scene/mesh_store.h"
#include "engine/scene/scene_changes.h"

#include <vector>

namespace sunfleck::gi {

// Boxes around the parts of static triangles that lie in one cell of a grid, in the space of the changes. A cell is a
// forty-eighth of the scene's longest side. In an order that only depends on the geometry.
std::vector<Bounds> receiver_cells(const scene::SceneChanges& changes, const scene::MeshStore& meshes);

} // namespace sunfleck::gi

// Procedural meshes. Counter-clockwise fronts, outward normals, sizes in metres, centred on the origin unless stated
// otherwise.
#pragma once

#include "engine/scene/components.h"
#include "engine/scene/mesh_store.h"

namespace sunfleck::scene {

// In the XY plane, facing +Z, divided into columns x rows quads.
Mesh make_rectangle(float width, float height, int columns = 1, int rows = 1);
Mesh make_box(vec3 size);
// The same box with its faces pointing inwards: a room.
Mesh make_room(vec3 size);
// In the XY plane, facing +Z. The polygon has the disc's exact area.
Mesh make_disc(float radius, int segments = 64);
// The polyhedron has the sphere's exact area; normals are the sphere's.
Mesh make_sphere(float radius, int segments = 64, int rings = 32);
// About the Y axis.
Mesh make_cylinder(float radius, float height, int segments = 32);
// About the Y axis: ring radius and tube radius. Vertices: segments x sides.
Mesh make_torus(float ring_radius, float tube_radius, int segments = 41, int sides = 20);
// A many-lobed, knotted closed tube of about 3,000 vertices: a complex mover in place of scanned models.
Mesh make_knot(float size, int segments = 150, int sides = 20);

// Mesh of an area light's shape.
Mesh make_area_light_mesh(const AreaLight& light);

// Recomputes smooth normals from area-weighted face normals.
void compute_normals(Mesh& mesh);

} // namespace sunfleck::scene

// Makes meshes of glTF files ready for lighting: flat normals, and solid bodies for points and lines.
#pragma once

#include "engine/scene/deformation.h"

namespace sunfleck::io {

// Without normals, faces are flat (glTF 2.0, sec. 3.7.2.1): each triangle gets its own vertices.
void make_flat(scene::DeformableMesh& mesh);

// Points become small octahedra and lines thin prisms, with a radius of a thousandth of the mesh's size: only surfaces
// can be lit and cast shadows. `mode`: of the primitive, 0 to 3. False, with no triangles, if there are too many.
bool make_solid(scene::DeformableMesh& mesh, const std::vector<std::uint32_t>& indices, int mode);

} // namespace sunfleck::io

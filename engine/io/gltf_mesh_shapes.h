// What meshes from glTF files need before they can be lit: flat normals, and bodies for points and lines.
#pragma once

#include "engine/scene/deformation.h"

namespace sunfleck::io {

// Without normals, faces are flat (glTF 2.0, sec. 3.7.2.1): every triangle gets vertices of its own.
void make_flat(scene::DeformableMesh& mesh);

// Points become small octahedra, lines thin prisms, with a radius of a thousandth of the mesh's size: what is lit and
// casts shadows has a surface. `mode`: of the primitive, 0 to 3. False, and no triangles, if there are too many.
bool make_solid(scene::DeformableMesh& mesh, const std::vector<std::uint32_t>& indices, int mode);

} // namespace sunfleck::io

// Primitives of glTF meshes: attributes, indices, modes, morph targets and skin weights (glTF 2.0, sec. 3.7.2).
#pragma once

#include "engine/io/gltf_accessor.h"
#include "engine/scene/deformation.h"

namespace sunfleck::io {

struct ImportedPrimitive {
    scene::DeformableMesh mesh; // `rest` is the mesh; the other members are empty unless it deforms
    int material = -1;          // index in the file
    std::vector<int> material_of_variant;
    bool drawn = true; // false: too many points or lines
    bool deforms() const { return !mesh.targets.empty() || mesh.influences > 0; }
};

Result<ImportedPrimitive> read_primitive(const tinygltf::Model& model, const tinygltf::Primitive& primitive,
                                         std::size_t variants);

// Tangents from the gradients of a set of texture coordinates (0 or 1), for meshes without tangents.
void generate_tangents(scene::Mesh& mesh, int set);

} // namespace sunfleck::io

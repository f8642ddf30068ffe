// Deforming meshes: skins and morph targets as in glTF 2.0, sec. 3.7.2.2 and 3.7.3, on the CPU, so that
// raster, shadow maps and rays see the same vertices.
#pragma once

#include "engine/scene/components.h"
#include "engine/scene/mesh_store.h"

#include <memory>
#include <vector>

namespace sunfleck::scene {

struct MorphTarget {
    std::vector<vec3> positions, normals; // displacement at weight 1; normals may be empty
};

// The rest pose, shared by all entities that deform it.
struct DeformableMesh {
    Mesh rest;
    std::vector<MorphTarget> targets;
    // Skin: `influences` per vertex, whose weights sum to 1; empty without a skin.
    std::uint32_t influences = 0;
    std::vector<std::uint32_t> joints; // indices into Deformation::joints
    std::vector<float> weights;
};

// Weights of morph targets; key frames may animate them.
struct MorphWeights {
    std::vector<float> weights;
};

// The entity's mesh (its own, in the store) follows joints and weights. With a skin, vertices are in world space, and
// the entity's own transform must be the identity.
struct Deformation {
    std::shared_ptr<const DeformableMesh> source;
    std::vector<ecs::Entity> joints;
    std::vector<mat4> inverse_bind_matrices; // mesh space to the joint's rest space, one per joint
    ecs::Entity weights_of;                  // has the MorphWeights; null: no targets
    std::vector<mat4> pose;                  // current pose of the mesh; set by deform_meshes
    std::vector<float> pose_weights;
};

// Vertices of `source` under joint matrices (world matrix times inverse bind matrix) and weights.
Mesh deformed(const DeformableMesh& source, const std::vector<mat4>& joints, const std::vector<float>& weights);

// Brings the meshes of all Deformations up to date with WorldTransforms and MorphWeights. Meshes whose pose is
// unchanged keep their revision. True if any changed.
bool deform_meshes(ecs::Registry& registry, MeshStore& meshes);

} // namespace sunfleck::scene

// Meshes that change their shape: skins and morph targets as in glTF 2.0, sec. 3.7.2.2 and 3.7.3, on the CPU, so that
// raster, shadow maps and rays see the same vertices.
#pragma once

#include "engine/scene/components.h"
#include "engine/scene/mesh_store.h"

#include <memory>
#include <vector>

namespace sunfleck::scene {

struct MorphTarget {
    std::vector<vec3> positions, normals; // what a weight of 1 adds; normals may be empty
};

// Vertices at rest, shared by all entities that bend them.
struct DeformableMesh {
    Mesh rest;
    std::vector<MorphTarget> targets;
    // Skin: `influences` a vertex, all weights of a vertex sum up to 1; empty without a skin.
    std::uint32_t influences = 0;
    std::vector<std::uint32_t> joints; // numbers within Deformation::joints
    std::vector<float> weights;
};

// Weights of morph targets; key frames may set them.
struct MorphWeights {
    std::vector<float> weights;
};

// The entity's mesh (its own, in the store) follows joints and weights. With a skin, vertices are in world space, and
// the entity's own transform must be the identity.
struct Deformation {
    std::shared_ptr<const DeformableMesh> source;
    std::vector<ecs::Entity> joints;
    std::vector<mat4> inverse_bind_matrices; // mesh space to the joint's space at rest, one a joint
    ecs::Entity weights_of;                  // has the MorphWeights; null: no targets
    std::vector<mat4> pose;                  // that the mesh is in; made by deform_meshes
    std::vector<float> pose_weights;
};

// Vertices of `source` under joint matrices (world matrix times inverse bind matrix) and weights.
Mesh deformed(const DeformableMesh& source, const std::vector<mat4>& joints, const std::vector<float>& weights);

// Brings the meshes of all Deformations up to date with WorldTransforms and MorphWeights. Meshes whose pose is the same
// keep their revision. True if any changed.
bool deform_meshes(ecs::Registry& registry, MeshStore& meshes);

} // namespace sunfleck::scene

// What moves, on its way into a glTF file: morph targets, skins and animations. Not for use outside this folder.
#pragma once

#include "engine/core/result.h"
#include "engine/ecs/registry.h"
#include "engine/io/gltf_writer.h"
#include "engine/scene/animation.h"
#include "engine/scene/deformation.h"

namespace sunfleck::io {

struct ByIndex {
    bool operator()(ecs::Entity a, ecs::Entity b) const { return a.index < b.index; }
};
using NodeNumbers = std::map<ecs::Entity, int, ByIndex>;

// The entity's mesh as it is before joints and weights deform it; null: nothing does.
const scene::Deformation* deformation_of(const ecs::Registry& registry, ecs::Entity entity);

class MotionExport {
public:
    MotionExport(GltfWriter& file, ecs::Registry& registry) : file_(file), registry_(registry) {}

    // Adds morph targets, joints and weights to a primitive that has the rest pose.
    void add_deformation(const scene::DeformableMesh& mesh, tinygltf::Primitive& primitive);
    // A node that will have the number, and such a primitive.
    void add_node(const scene::Deformation& deformation, int number, tinygltf::Node& node);
    // Once all nodes are there.
    Status finish(const NodeNumbers& nodes);

private:
    struct Clip {
        std::string name;
        std::vector<std::pair<ecs::Entity, const scene::Animation*>> parts;
    };
    struct Deforming {
        int node;
        const scene::Deformation* deformation;
    };
    int skin_of(const scene::Deformation& deformation, const NodeNumbers& nodes);
    void mark_weights(const Deforming& one, const NodeNumbers& nodes);
    int stand_in(ecs::Entity joint, std::size_t place, int above);
    void add_clip(const Clip& clip, bool played, const NodeNumbers& nodes);
    int add_sampler(tinygltf::Animation& target, const std::vector<float>& times, int output,
                    scene::AnimationInterpolation interpolation);
    void add_curves(const scene::Animation& animation, int node, tinygltf::Animation& target);
    void add_weights(const scene::WeightCurve& curve, const Deforming& deforming, tinygltf::Animation& target);

    GltfWriter& file_;
    ecs::Registry& registry_;
    std::vector<Deforming> deforming_;
    std::map<EntityBits, std::vector<Deforming>> moved_by_; // by Deformation::weights_of
    std::map<std::pair<EntityBits, std::size_t>, int> stand_ins_;
    Status problem_;
};

} // namespace sunfleck::io

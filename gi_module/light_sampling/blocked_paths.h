// Which VPLs get no light because a mover stands in the path that it came by. Random walks see static geometry only, so
// without this a closed door would let light of the room before it be reflected in the room behind it.
//
// Only large boxes that cast shadows count (doors, panels, platforms): a sample stands for a wide beam, which smaller
// things do not block.
#pragma once

#include "engine/scene/scene_changes.h"
#include "gi_module/transport/light_sample.h"

#include <map>
#include <span>

namespace sunfleck::gi {

class BlockedPaths {
public:
    static constexpr float smallest_side = 0.5f; // m: two sides of a box must be longer

    // `generation`: another number means other samples. Looks at movers that changed only, and at the samples only
    // where such a box came, went or moved.
    void update(const scene::SceneChanges& changes, const scene::MeshStore& meshes,
                std::span<const LightSample> samples, std::uint64_t generation);
    // Looks at some samples again, which have changed since.
    void check(std::span<const LightSample> samples, std::span<const std::uint32_t> changed);
    bool is_blocked(std::uint32_t sample) const { return sample < blocked_.size() && blocked_[sample] != 0; }
    bool is_box(ecs::Entity mover) const { return boxes_.count(mover) != 0; }
    // Whether any box stands in the sample's path. A box does not block the light that leaves itself, but may stand in
    // its way later.
    bool blocks(const LightSample& sample) const;
    std::size_t count() const { return count_; }

private:
    struct Box {
        mat4 matrix, inverse;
        Bounds bounds; // in the mesh's space
        bool operator==(const Box& other) const {
            return matrix == other.matrix && bounds.minimum == other.bounds.minimum &&
                   bounds.maximum == other.bounds.maximum;
        }
    };
    static bool is_large_box(const scene::Mesh& mesh, const Bounds& bounds, const mat4& matrix);
    static bool crosses(const Box& box, vec3 from, vec3 to);
    static bool crosses_path(const Box& box, const LightSample& sample, std::uint32_t first_leg);

    bool follow(const scene::SceneChanges& changes, const scene::MeshStore& meshes);
    bool follow_one(const scene::DrawableChange& change, const scene::MeshStore& meshes);

    scene::ChangeCursor cursor_;
    std::map<ecs::Entity, Box> boxes_;
    std::vector<std::uint8_t> blocked_; // by sample
    std::uint64_t generation_ = 0;
    std::size_t count_ = 0;
};

} // namespace sunfleck::gi

// Which reflected samples get no light because something stands in the way that it came. Walks see static geometry
// only, so without this a closed door would reflect, in the room behind it, the light of the room before it.
//
// Only large boxes that cast shadows count (doors, panels, platforms): a sample stands for a wide beam, which smaller
// things do not block.
#pragma once

#include "engine/scene/gpu_scene.h"
#include "gi_module/transport/light_sample.h"

#include <span>

namespace sunfleck::gi {

class BlockedPaths {
public:
    static constexpr float smallest_side = 0.5f; // m: two sides of a box must be longer

    // `generation`: another number means other samples. Does nothing where no such box has moved.
    void update(ecs::Registry& registry, const scene::MeshStore& meshes, const scene::GpuScene& gpu_scene,
                std::span<const LightSample> samples, std::uint64_t generation);
    bool is_blocked(std::uint32_t sample) const { return sample < blocked_.size() && blocked_[sample] != 0; }
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
    static bool crosses_path(const Box& box, const LightSample& sample);

    std::vector<Box> boxes_;
    std::vector<std::uint8_t> blocked_; // by sample
    std::uint64_t generation_ = 0;
    std::size_t count_ = 0;
};

} // namespace sunfleck::gi

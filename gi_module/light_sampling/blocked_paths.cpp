#include "gi_module/light_sampling/blocked_paths.h"

#include <algorithm>

namespace sunfleck::gi {

// All corners of the mesh are corners of its bounds, and all of those are taken.
bool BlockedPaths::is_large_box(const scene::Mesh& mesh, const Bounds& bounds, const mat4& matrix) {
    if (mesh.positions.size() > 64)
        return false;
    int large = 0;
    for (int axis = 0; axis < 3; ++axis)
        large += bounds.extent()[axis] * glm::length(vec3(matrix[axis])) > smallest_side;
    if (large < 2)
        return false;
    std::uint32_t corners = 0;
    for (const vec3 p : mesh.positions) {
        std::uint32_t corner = 0;
        for (int axis = 0; axis < 3; ++axis) {
            if (p[axis] != bounds.minimum[axis] && p[axis] != bounds.maximum[axis])
                return false;
            corner |= p[axis] == bounds.maximum[axis] ? 1u << axis : 0u;
        }
        corners |= 1u << corner;
    }
    return corners == 0xffu;
}

bool BlockedPaths::crosses(const Box& box, vec3 from, vec3 to) {
    const vec3 start(box.inverse * vec4(from, 1.0f)), along(box.inverse * vec4(to - from, 0.0f));
    float enter = 0.0f, leave = 1.0f;
    for (int axis = 0; axis < 3; ++axis) {
        if (std::abs(along[axis]) < 1e-12f) {
            if (start[axis] < box.bounds.minimum[axis] || start[axis] > box.bounds.maximum[axis])
                return false;
            continue;
        }
        const float a = (box.bounds.minimum[axis] - start[axis]) / along[axis];
        const float b = (box.bounds.maximum[axis] - start[axis]) / along[axis];
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
    }
    return enter < leave;
}

bool BlockedPaths::crosses_path(const Box& box, const LightSample& sample) {
    for (std::uint32_t leg = 0; leg < sample.path_vertex_count; ++leg)
        if (crosses(box, sample.path[leg], leg + 1 < sample.path_vertex_count ? sample.path[leg + 1] : sample.position))
            return true;
    return false;
}

void BlockedPaths::update(ecs::Registry& registry, const scene::MeshStore& meshes, const scene::GpuScene& gpu_scene,
                          std::span<const LightSample> samples, std::uint64_t generation) {
    std::vector<Box> boxes;
    for (const scene::DrawItem& item : gpu_scene.draws()) {
        if (item.is_static || !item.casts_shadow)
            continue;
        const std::uint32_t mesh = registry.get<scene::MeshInstance>(item.entity).mesh;
        const mat4& matrix = registry.get<scene::WorldTransform>(item.entity).matrix;
        if (is_large_box(meshes[mesh], meshes.bounds(mesh), matrix))
            boxes.push_back({matrix, glm::inverse(matrix), meshes.bounds(mesh)});
    }
    if (boxes == boxes_ && generation == generation_ && blocked_.size() == samples.size())
        return;
    boxes_ = std::move(boxes);
    generation_ = generation;
    blocked_.assign(samples.size(), 0);
    for (std::size_t i = 0; i < samples.size(); ++i)
        blocked_[i] =
            std::any_of(boxes_.begin(), boxes_.end(), [&](const Box& box) { return crosses_path(box, samples[i]); });
    count_ = std::size_t(std::count(blocked_.begin(), blocked_.end(), std::uint8_t(1)));
}

} // namespace sunfleck::gi

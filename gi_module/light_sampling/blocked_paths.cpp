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

bool BlockedPaths::crosses_path(const Box& box, const LightSample& sample, std::uint32_t first_leg) {
    for (std::uint32_t leg = first_leg; leg < sample.path_vertex_count; ++leg)
        if (crosses(box, sample.path[leg], leg + 1 < sample.path_vertex_count ? sample.path[leg + 1] : sample.position))
            return true;
    return false;
}

bool BlockedPaths::blocks(const LightSample& sample) const {
    return std::any_of(boxes_.begin(), boxes_.end(), [&](const auto& entry) {
        return crosses_path(entry.second, sample, sample.dynamic && entry.first == sample.emitter ? 1 : 0);
    });
}

void BlockedPaths::check(std::span<const LightSample> samples, std::span<const std::uint32_t> changed) {
    for (const std::uint32_t i : changed) {
        const std::uint8_t now = blocks(samples[i]) ? 1 : 0;
        count_ = count_ + now - blocked_[i];
        blocked_[i] = now;
    }
}

bool BlockedPaths::follow_one(const scene::DrawableChange& change, const scene::MeshStore& meshes) {
    const scene::Drawable* now = change.now;
    const auto known = boxes_.find(change.entity);
    const bool blocks = now != nullptr && !now->is_static && now->casts_shadow &&
                        is_large_box(meshes[now->mesh], meshes.bounds(now->mesh), now->matrix);
    if (!blocks) {
        if (known == boxes_.end())
            return false;
        boxes_.erase(known);
        return true;
    }
    const Box box{now->matrix, glm::inverse(now->matrix), meshes.bounds(now->mesh)};
    if (known != boxes_.end() && known->second == box)
        return false;
    boxes_[change.entity] = box;
    return true;
}

// True if a box came, went or moved.
bool BlockedPaths::follow(const scene::SceneChanges& changes, const scene::MeshStore& meshes) {
    bool changed = false;
    if (cursor_.follows(changes)) {
        for (const scene::DrawableChange& change : changes.drawables)
            changed = (change.is_mover() && follow_one(change, meshes)) || changed;
    } else {
        boxes_.clear();
        changed = true;
        for (const scene::Drawable* drawable : changes.all)
            follow_one({drawable->entity, nullptr, drawable}, meshes);
    }
    cursor_.saw(changes);
    return changed;
}

void BlockedPaths::update(const scene::SceneChanges& changes, const scene::MeshStore& meshes,
                          std::span<const LightSample> samples, std::uint64_t generation) {
    const bool same_boxes = !follow(changes, meshes);
    if (same_boxes && generation == generation_ && blocked_.size() == samples.size())
        return;
    generation_ = generation;
    blocked_.assign(samples.size(), 0);
    for (std::size_t i = 0; i < samples.size(); ++i)
        blocked_[i] = blocks(samples[i]) ? 1 : 0;
    count_ = std::size_t(std::count(blocked_.begin(), blocked_.end(), std::uint8_t(1)));
}

} // namespace sunfleck::gi

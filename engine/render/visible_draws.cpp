#include "engine/render/visible_draws.h"

#include <algorithm>
#include <utility>

namespace sunfleck::render {
namespace {

bool outside(const mat4& view_projection, const Bounds& bounds) {
    // Outside of one plane of the view with all corners. Reverse Z: the near plane is z = w, the far one at infinity.
    int left = 0, right = 0, below = 0, above = 0, behind = 0;
    for (int i = 0; i < 8; ++i) {
        const vec3 corner(i & 1 ? bounds.maximum.x : bounds.minimum.x, i & 2 ? bounds.maximum.y : bounds.minimum.y,
                          i & 4 ? bounds.maximum.z : bounds.minimum.z);
        const vec4 clip = view_projection * vec4(corner, 1.0f);
        left += clip.x < -clip.w;
        right += clip.x > clip.w;
        below += clip.y < -clip.w;
        above += clip.y > clip.w;
        behind += clip.w < 0.0f;
    }
    return left == 8 || right == 8 || below == 8 || above == 8 || behind == 8;
}

} // namespace

std::vector<const scene::DrawItem*> visible_from(const shared::CameraRow& camera,
                                                 const std::vector<scene::DrawItem>& draws) {
    std::vector<std::pair<float, const scene::DrawItem*>> seen;
    const vec3 eye(camera.position);
    for (const scene::DrawItem& item : draws)
        if (!outside(camera.view_projection, item.bounds)) {
            const vec3 nearest = glm::clamp(eye, item.bounds.minimum, item.bounds.maximum);
            seen.emplace_back(glm::length(nearest - eye), &item);
        }
    std::stable_sort(seen.begin(), seen.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<const scene::DrawItem*> result;
    for (const auto& [distance, item] : seen)
        result.push_back(item);
    return result;
}

VkCullModeFlags hidden_faces(const shared::CameraRow& camera, const scene::DrawItem& item) {
    const vec3 eye(camera.position);
    const vec3 nearest = glm::clamp(eye, item.bounds.minimum, item.bounds.maximum);
    // The near plane must not cut it open: its corners are so far away at most.
    const float reach = camera.position.w * (glm::length(vec3(camera.forward)) + glm::length(vec3(camera.right)) +
                                             glm::length(vec3(camera.down)));
    const bool solid = item.closed && item.kind != scene::surface_kind_holes && glm::length(nearest - eye) > reach;
    return item.single_sided || solid ? VK_CULL_MODE_BACK_BIT : VK_CULL_MODE_NONE;
}

} // namespace sunfleck::render

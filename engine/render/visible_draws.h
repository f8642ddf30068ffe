// Which of a scene's draws a picture needs, and in which order.
#pragma once

#include "engine/scene/camera_view.h"
#include "engine/scene/gpu_scene.h"

#include <vector>

namespace sunfleck::render {

// What the camera may see, nearest first: what is hidden by then is not shaded. They point into `draws`.
std::vector<const scene::DrawItem*> visible_from(const shared::CameraRow& camera,
                                                 const std::vector<scene::DrawItem>& draws);

// Of an item: its back faces, if its material hides them, or if it is solid and the camera outside of it, which draws
// the same in half the time; or none.
VkCullModeFlags hidden_faces(const shared::CameraRow& camera, const scene::DrawItem& item);

inline VkFrontFace front_face(const scene::DrawItem& item) {
    return item.mirrored ? VK_FRONT_FACE_CLOCKWISE : VK_FRONT_FACE_COUNTER_CLOCKWISE;
}

} // namespace sunfleck::render

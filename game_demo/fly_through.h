// Where the camera is at a simulation step: once round the room in 20 s, outside the pillars, rising and sinking.
#pragma once

#include "engine/scene/camera_view.h"

namespace sunfleck::demo {

inline scene::CameraView fly_through(std::uint64_t step) {
    const float turn = 2.0f * pi * float(step % 1200) / 1200.0f;
    scene::CameraView view;
    view.position = vec3(3.3f * std::sin(turn), 1.7f + 0.5f * std::sin(2.0f * turn), 3.3f * std::cos(turn));
    view.target = vec3(0.6f * std::sin(turn + 2.2f), 1.2f, 0.6f * std::cos(turn + 2.2f));
    view.vertical_field_of_view = glm::radians(66.0f);
    return view;
}

} // namespace sunfleck::demo

// What is drawn over the picture of the scene, in the viewport's pixels.
#pragma once

#include "editor/window/session.h"

namespace sunfleck::editor {

inline vec2 viewport_size(const Session& session) {
    return {session.viewport_area.z, session.viewport_area.w};
}
inline vec2 viewport_corner(const Session& session) {
    return {session.viewport_area.x, session.viewport_area.y};
}
inline vec2 pointer_in_viewport(const Session& session) {
    const ImVec2 place = ImGui::GetIO().MousePos;
    return vec2(place.x, place.y) - viewport_corner(session);
}

} // namespace sunfleck::editor

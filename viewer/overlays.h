// Lines that can be drawn over a picture: those of the lighting (gi::all_overlays()) and of the scene itself.
#pragma once

#include "viewer/scene_renderer.h"

namespace sunfleck::viewer {

// In the order in which menus offer them.
std::vector<const gi::Overlay*> overlays();
// One of them by name, as of the renderer's last update; an error if there is none.
Status draw_overlay(SceneRenderer& renderer, std::string_view name, gi::OverlayLines& lines);

} // namespace sunfleck::viewer

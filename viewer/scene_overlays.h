// Lines that show what a scene's components mean, where no surface does: lamps, areas and sensors of games, movers'
// ways.
#pragma once

#include "viewer/scene_renderer.h"

namespace sunfleck::viewer {

// In the order in which menus offer them.
std::span<const gi::Overlay> scene_overlays();
// One of them, by its code, as of the renderer's last update.
void draw_scene_overlay(std::uint32_t code, SceneRenderer& renderer, gi::OverlayLines& lines);

} // namespace sunfleck::viewer

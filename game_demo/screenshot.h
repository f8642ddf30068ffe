// Pictures that the player takes.
#pragma once

#include "viewer/scene_renderer.h"

namespace sunfleck::demo {

// Saves the last frame as the first unused sunfleck_NNNN.png of the folder. Returns what to tell the player: the whole
// path, or why there is no picture.
std::string save_screenshot(viewer::SceneRenderer& renderer, const std::filesystem::path& folder);

} // namespace sunfleck::demo

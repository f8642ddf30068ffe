// What menus and overlays show of a level.
#pragma once

#include "game_demo/level.h"
#include "game_demo/menu.h"

namespace sunfleck::demo {

// All that the level knows itself; the rest is as by default. Takes the time of its light sensors.
OverlayData overlay_data(Level& level, const viewer::FrameRequest& request);

} // namespace sunfleck::demo

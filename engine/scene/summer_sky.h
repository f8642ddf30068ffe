// A sky made by code, for scenes that want one behind their windows without a file: summer, clouds over hills.
#pragma once

#include "engine/scene/environment_map.h"

#include <string_view>

namespace sunfleck::scene {

// EnvironmentMap::file that asks for it.
inline constexpr std::string_view summer_sky_name = "summer_sky";

// Radiance relative to the Environment's: haze at the horizon has not quite half of it, so that a picture that is
// exposed for a room shows more than white; blue is darker, clouds are up to one and a half times as bright as haze.
// Without a sun. Made once, and the same on every machine up to rounding.
std::shared_ptr<const EnvironmentImage> summer_sky();

} // namespace sunfleck::scene

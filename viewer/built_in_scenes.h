// The scenes that come with the programs, by name.
#pragma once

#include "engine/core/result.h"

#include <filesystem>
#include <string>
#include <vector>

namespace sunfleck::viewer {

// In alphabetical order. They lie beside the program: in ../scenes of a build, in ../share/sunfleck/scenes when
// installed, or in the folder that SUNFLECK_SCENES names.
std::vector<std::string> built_in_scene_names();

// A path as it is, or the file of the built-in scene of that name. The error lists the names, the most similar first.
Result<std::filesystem::path> find_scene(const std::string& scene);

} // namespace sunfleck::viewer

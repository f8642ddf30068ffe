// The pictures of skies (scene::EnvironmentMap) beside a scene file. Not for use outside this folder.
#pragma once

#include "engine/io/file_access.h"
#include "engine/scene/components.h"

#include <nlohmann/json_fwd.hpp>

namespace sunfleck::io {

// Pictures that cannot be read are noted; the scene is whole without them, and keeps their names. An error only where
// memory runs out. `for_saving`: ImportOptions::for_saving.
Status load_sky_pictures(const std::filesystem::path& folder, const FileAccess& access, ecs::Registry& registry,
                         bool for_saving, std::vector<std::string>& notes);

// Writes the pictures that the scene has brought along (scene::PictureFile) beside the scene file at `path`, where they
// are not there yet, and what they are called there into `entities`. A scene file reaches no other place. No file that
// is there is replaced.
Status save_sky_pictures(const std::filesystem::path& path, ecs::Registry& registry, nlohmann::json& entities);

} // namespace sunfleck::io

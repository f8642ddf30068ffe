// Tables of what was measured of the game in its window, beside the targets.
#pragma once

#include "engine/core/result.h"

#include <filesystem>

namespace sunfleck::bench {

// Of all results in a folder (by KIND, before or after: KIND-NAME-ROOM.json). False: a target is missed, or something
// was not measured.
Result<bool> report(const std::filesystem::path& folder);

} // namespace sunfleck::bench

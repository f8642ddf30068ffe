// Where a user's own files lie. Empty where the variables name no absolute folder: nothing is kept then, since any
// other place may be shared, or be somebody's work.
#pragma once

#include <filesystem>

namespace sunfleck {

// $XDG_CACHE_HOME/sunfleck or ~/.cache/sunfleck: data that can be computed again.
std::filesystem::path user_cache_folder();
// $XDG_CONFIG_HOME/sunfleck or ~/.config/sunfleck: settings.
std::filesystem::path user_settings_folder();
// $XDG_DATA_HOME/sunfleck or ~/.local/share/sunfleck: saved games.
std::filesystem::path user_data_folder();

} // namespace sunfleck

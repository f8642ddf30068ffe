// Where a user's own files lie. Empty where the variables name no absolute folder: nothing is kept then, since any
// other place may be shared, or be somebody's work. The cache's is in file.h.
#pragma once

#include <filesystem>

namespace sunfleck {

// $XDG_CONFIG_HOME/sunfleck or ~/.config/sunfleck: settings.
std::filesystem::path user_settings_folder();
// $XDG_DATA_HOME/sunfleck or ~/.local/share/sunfleck: saved games.
std::filesystem::path user_data_folder();

} // namespace sunfleck

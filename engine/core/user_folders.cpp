#include "engine/core/user_folders.h"

#include <cstdlib>

namespace sunfleck {
namespace {

std::filesystem::path user_folder(const char* variable, const char* below_home) {
    if (const char* folder = std::getenv(variable); folder != nullptr && folder[0] == '/')
        return std::filesystem::path(folder) / "sunfleck";
    const char* home = std::getenv("HOME");
    return home != nullptr && home[0] == '/' ? std::filesystem::path(home) / below_home / "sunfleck"
                                             : std::filesystem::path();
}

} // namespace

std::filesystem::path user_cache_folder() {
    return user_folder("XDG_CACHE_HOME", ".cache");
}

std::filesystem::path user_settings_folder() {
    return user_folder("XDG_CONFIG_HOME", ".config");
}

std::filesystem::path user_data_folder() {
    return user_folder("XDG_DATA_HOME", ".local/share");
}

} // namespace sunfleck

#include "game_demo/kept_settings.h"

namespace sunfleck::demo {

LoadedSettings KeptSettings::load(const std::string& file) {
    path_ = file.empty() ? settings_path() : std::filesystem::path(file);
    if (!path_.empty())
        return load_settings(path_);
    LoadedSettings none;
    none.problem = "Settings are not kept: neither HOME nor XDG_CONFIG_HOME is set (--settings FILE names a file)";
    return none;
}

void KeptSettings::begin(const DemoSettings& settings, bool found) {
    first_ = settings_text(settings);
    saved_ = found ? first_ : std::string();
}

Status KeptSettings::store(const DemoSettings& settings) {
    std::string text = settings_text(settings);
    if (path_.empty() || text == saved_)
        return {};
    if (const Status status = save_settings(path_, settings); !status)
        return Error{"the settings are not saved: " + status.error().message};
    saved_ = std::move(text);
    return {};
}

} // namespace sunfleck::demo

// The player's settings between a program's start and end: read once, and written where they differ from the file.
#pragma once

#include "game_demo/demo_settings.h"

namespace sunfleck::demo {

class KeptSettings {
public:
    // `file`: empty for the default one, if there is a place for it.
    LoadedSettings load(const std::string& file);
    // What holds at the start, after presets and options.
    void begin(const DemoSettings& settings, bool found);
    // Writes them where the file says something else.
    Status store(const DemoSettings& settings);
    // Whether something would be lost without a store.
    bool differ_from_start(const DemoSettings& settings) const { return settings_text(settings) != first_; }

private:
    std::filesystem::path path_;
    std::string first_, saved_; // as text: at the start, and in the file
};

} // namespace sunfleck::demo

// The player's settings, saved between sessions.
#pragma once

#include "engine/app/window.h"
#include "engine/core/description.h"
#include "viewer/quality.h"

#include <filesystem>
#include <optional>

namespace sunfleck::demo {

// Quality presets. `software` is for machines without a GPU.
enum class Preset : std::uint32_t { software, low, medium, high, ultra, custom };

enum class Action : std::uint32_t {
    forward,
    back,
    left,
    right,
    run,
    crouch,
    use,
    put_down,
    look_left,
    look_right,
    look_up,
    look_down,
    indirect_light,
    frame_times,
    screenshot,
    help,
    full_screen,
    count
};
inline constexpr std::size_t action_count = std::size_t(Action::count);
// The key in the settings file, and the label in the menu.
const char* action_name(Action action);
const char* action_label(Action action);

struct DemoSettings {
    Preset preset = Preset::software;
    float render_scale = 0.5f;
    std::uint32_t light_samples = 200;
    std::uint32_t map_budget = 40;
    bool transfer = false;
    bool antialiasing = true;
    bool temporal = true;
    float glare = 0.03f;
    float exposure = 0.0f;
    bool adaptation = true;
    float field_of_view = viewer::usual_field_of_view;
    float sensitivity = 1.0f;
    bool invert_look = false;
    std::uint32_t frame_cap = 60;
    float frame_milliseconds = 0.0f;
    bool vertical_sync = true;
    bool full_screen = false;
    bool show_times = false;
    float ui_scale = 1.0f;
    float volume = 0.6f;
    bool subtitles = false;
    std::array<app::Key, action_count> bindings{};
    // Not saved: the light of what stands still is refined as the preset says. What soon gives way to other light is
    // not.
    bool refines = true;

    DemoSettings();
    static const TypeDescription& description();
    // What `key` does, if anything.
    std::optional<Action> action_of(app::Key key) const;
};

// $XDG_CONFIG_HOME/sunfleck/demo.json, or the same under ~/.config. Empty if neither variable is set: settings are kept
// nowhere then, since any other place may be shared.
std::filesystem::path settings_path();

struct LoadedSettings {
    DemoSettings settings;
    bool found = false;
    std::string problem; // what was wrong with the file; a damaged file is renamed with ".damaged" appended
};
// The content of the file.
std::string settings_text(const DemoSettings& settings);
// Valid entries of the file are used; the rest keep their defaults.
LoadedSettings load_settings(const std::filesystem::path& path);
Status save_settings(const std::filesystem::path& path, const DemoSettings& settings);

} // namespace sunfleck::demo

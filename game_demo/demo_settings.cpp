#include "game_demo/demo_settings.h"

#include "engine/core/file.h"
#include "engine/core/user_folders.h"
#include "viewer/picture_settings.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace sunfleck::demo {
namespace {

struct ActionInfo {
    const char* name;
    const char* label;
    app::Key key;
};
constexpr ActionInfo actions[action_count] = {{"forward", "Walk forward", 'W'},
                                              {"back", "Walk back", 'S'},
                                              {"left", "Strafe left", 'A'},
                                              {"right", "Strafe right", 'D'},
                                              {"run", "Run", app::key_left_shift},
                                              {"crouch", "Crouch", 'C'},
                                              {"use", "Use or take", 'E'},
                                              {"put_down", "Put down the lantern", 'Q'},
                                              {"look_left", "Look left", app::key_left},
                                              {"look_right", "Look right", app::key_right},
                                              {"look_up", "Look up", app::key_up},
                                              {"look_down", "Look down", app::key_down},
                                              {"indirect_light", "Toggle indirect light", 'L'},
                                              {"frame_times", "Show frame times", 'T'},
                                              {"screenshot", "Take a screenshot", 'P'},
                                              {"help", "Help", 'H'},
                                              {"full_screen", "Full screen", 'F'}};

} // namespace

const char* action_name(Action action) {
    return actions[std::size_t(action)].name;
}
const char* action_label(Action action) {
    return actions[std::size_t(action)].label;
}

std::optional<Action> DemoSettings::action_of(app::Key key) const {
    const auto found = std::find(bindings.begin(), bindings.end(), key);
    return found == bindings.end() ? std::nullopt : std::optional(Action(found - bindings.begin()));
}

DemoSettings::DemoSettings() {
    for (std::size_t i = 0; i < action_count; ++i)
        bindings[i] = actions[i].key;
}

const TypeDescription& DemoSettings::description() {
    static const TypeDescription type{
        "DemoSettings",
        1,
        "Settings of the demo.",
        {SUNFLECK_CHOICE(DemoSettings, preset, "Quality preset; software is for machines without a GPU", "software",
                         "low", "medium", "high", "ultra", "custom"),
         SUNFLECK_FIELD(DemoSettings, render_scale, "", 0.25, 1,
                        "Rendered size relative to the window; lower is faster but blurrier"),
         SUNFLECK_FIELD(DemoSettings, light_samples, "", 50, 4096,
                        "Number of virtual point lights; more give smoother lighting but are slower"),
         SUNFLECK_FIELD(DemoSettings, map_budget, "maps", 5, 1000,
                        "Shadow maps redrawn per frame; fewer are faster, but shadows of moving objects lag"),
         SUNFLECK_FIELD(DemoSettings, transfer, "", 0, 1,
                        "Lights complex moving objects by precomputed radiance transfer, with interreflection and "
                        "soft self-shadowing; slower"),
         SUNFLECK_FIELD(DemoSettings, antialiasing, "", 0, 1,
                        viewer::PictureSettings::description().find("antialiasing")->tooltip),
         SUNFLECK_FIELD(
             DemoSettings, temporal, "", 0, 1,
             "While one stands still, edges are smoothed and the picture is enlarged from frame to frame; off: "
             "each frame by itself"),
         SUNFLECK_FIELD(DemoSettings, glare, "", 0, 0.5, viewer::PictureSettings::description().find("glare")->tooltip),
         SUNFLECK_FIELD(DemoSettings, exposure, "EV", -4, 4, "Exposure compensation; higher is brighter"),
         SUNFLECK_FIELD(DemoSettings, adaptation, "", 0, 1,
                        "The exposure follows what is seen, as an eye adapts to bright and dark rooms"),
         SUNFLECK_FIELD(DemoSettings, field_of_view, "degrees", 40, 110, "Vertical field of view"),
         SUNFLECK_FIELD(DemoSettings, sensitivity, "", 0.1, 5, "Speed at which mouse, stick and keys turn the view"),
         SUNFLECK_FIELD(DemoSettings, invert_look, "", 0, 1, "Moving the mouse or stick forward looks down"),
         SUNFLECK_FIELD(DemoSettings, frame_cap, "Hz", 10, 1000, "Maximum frame rate"),
         SUNFLECK_FIELD(DemoSettings, frame_milliseconds, "ms", 0, 100,
                        "Time from frame to frame that is held by a larger or smaller rendered size and more or fewer "
                        "shadow maps; 0: the settings of the picture are kept"),
         SUNFLECK_FIELD(DemoSettings, vertical_sync, "", 0, 1, "Synchronises frames with the display to avoid tearing"),
         SUNFLECK_FIELD(DemoSettings, full_screen, "", 0, 1, "Uses the whole screen"),
         SUNFLECK_FIELD(DemoSettings, show_times, "", 0, 1, "Shows the time of each GPU pass and CPU stage"),
         SUNFLECK_FIELD(DemoSettings, ui_scale, "", 0.5, 3, "Size of text and menus"),
         SUNFLECK_FIELD(DemoSettings, volume, "", 0, 1, "Loudness of all sounds; 0 is silent"),
         SUNFLECK_FIELD(DemoSettings, subtitles, "", 0, 1, "Writes what is heard, and on which side")}};
    return type;
}

std::filesystem::path settings_path() {
    const std::filesystem::path folder = user_settings_folder();
    return folder.empty() ? folder : folder / "demo.json";
}

namespace {

// Finds a field under its present name, or under the name that earlier versions saved it by.
nlohmann::json::const_iterator find_field(const nlohmann::json& file, std::string_view name) {
    const auto found = file.find(std::string(name));
    if (found == file.end() && name == "ui_scale")
        return file.find("letter_scale");
    return found;
}

// Takes all valid bindings; the error names the last unknown key.
Status read_bindings(const nlohmann::json& bindings, DemoSettings& settings) {
    Status status;
    for (std::size_t i = 0; i < action_count; ++i) {
        const auto value = bindings.find(actions[i].name);
        if (value == bindings.end() || !value->is_string())
            continue;
        const app::Key key = app::key_by_name(value->get<std::string>());
        if (key == app::no_key)
            status = Error{"unknown key '" + value->get<std::string>() + "'"};
        else
            settings.bindings[i] = key;
    }
    return status;
}

} // namespace

LoadedSettings load_settings(const std::filesystem::path& path) {
    LoadedSettings result;
    std::error_code code;
    if (!std::filesystem::exists(path, code))
        return result;
    result.found = true;
    const auto text = read_file(path, 1u << 20);
    if (!text) { // what can't be read may be fine
        result.problem = text.error().message + "; default settings are used";
        return result;
    }
    const nlohmann::json file = nlohmann::json::parse(*text, nullptr, false);
    if (file.is_discarded() || !file.is_object()) {
        result.problem = "'" + path.string() + "' is damaged; default settings are used";
        set_aside(path);
        return result;
    }
    for (const Field& field : DemoSettings::description().fields) {
        const auto value = find_field(file, field.name);
        if (value == file.end())
            continue;
        const std::string entry = value->is_string() ? value->get<std::string>() : value->dump();
        if (const Status status = field_from_text(field, &result.settings, entry); !status)
            result.problem = "'" + path.string() + "': " + status.error().message;
    }
    if (const auto bindings = file.find("bindings"); bindings != file.end() && bindings->is_object())
        if (const Status status = read_bindings(*bindings, result.settings); !status)
            result.problem = "'" + path.string() + "': " + status.error().message;
    return result;
}

std::string settings_text(const DemoSettings& settings) {
    nlohmann::ordered_json file;
    for (const Field& field : DemoSettings::description().fields) {
        const std::string text = field_to_text(field, &settings);
        if (field.kind == FieldKind::choice)
            file[std::string(field.name)] = text;
        else
            file[std::string(field.name)] = nlohmann::json::parse(text);
    }
    for (std::size_t i = 0; i < action_count; ++i)
        file["bindings"][actions[i].name] = app::key_name(settings.bindings[i]);
    return file.dump(2) + "\n";
}

Status save_settings(const std::filesystem::path& path, const DemoSettings& settings) {
    std::error_code code;
    std::filesystem::create_directories(path.parent_path(), code);
    return write_file(path, settings_text(settings));
}

} // namespace sunfleck::demo

#include "game_demo/demo_settings.h"

#include "engine/core/file.h"

#include <cstdlib>
#include <nlohmann/json.hpp>

namespace sunfleck::demo {
namespace {

struct ActionWords {
    const char* name;
    const char* label;
    app::Key key;
};
constexpr ActionWords actions[action_count] = {{"forward", "Walk forward", 'W'},
                                               {"back", "Walk back", 'S'},
                                               {"left", "Step left", 'A'},
                                               {"right", "Step right", 'D'},
                                               {"run", "Run", app::key_left_shift},
                                               {"crouch", "Crouch", 'C'},
                                               {"use", "Use, take", 'E'},
                                               {"put_down", "Put the lantern down", 'Q'},
                                               {"indirect_light", "Bounced light on and off", 'L'},
                                               {"frame_times", "Frame times", 'T'},
                                               {"screenshot", "Save a picture", 'P'},
                                               {"help", "Help", 'H'},
                                               {"full_screen", "Full screen", 'F'}};

} // namespace

const char* action_name(Action action) {
    return actions[std::size_t(action)].name;
}
const char* action_label(Action action) {
    return actions[std::size_t(action)].label;
}

DemoSettings::DemoSettings() {
    for (std::size_t i = 0; i < action_count; ++i)
        bindings[i] = actions[i].key;
}

const TypeDescription& DemoSettings::description() {
    static const TypeDescription type{
        "DemoSettings",
        1,
        "What the player chooses.",
        {SUNFLECK_CHOICE(DemoSettings, preset, "How much work a frame is; software is for machines without a GPU",
                         "software", "low", "medium", "high", "ultra", "custom"),
         SUNFLECK_FIELD(DemoSettings, render_scale, "", 0.25, 1,
                        "Rendered size as a share of the window's; smaller is faster and softer"),
         SUNFLECK_FIELD(DemoSettings, light_samples, "", 50, 4096, "More make smoother light, and cost time"),
         SUNFLECK_FIELD(DemoSettings, map_budget, "maps", 5, 1000,
                        "Shadow maps redrawn a frame; fewer is faster, and shadows of moving things lag"),
         SUNFLECK_FIELD(DemoSettings, transfer, "", 0, 1,
                        "Round things that move are lit by precomputed transfer, also by what they reflect onto "
                        "themselves; their shadows on themselves are softer, and it costs time"),
         SUNFLECK_FIELD(DemoSettings, exposure, "EV", -4, 4, "Brighter to the right, darker to the left"),
         SUNFLECK_FIELD(DemoSettings, field_of_view, "degrees", 40, 110, "Angle of view from bottom to top"),
         SUNFLECK_FIELD(DemoSettings, sensitivity, "", 0.1, 5, "How far the view turns for a motion of the hand"),
         SUNFLECK_FIELD(DemoSettings, invert_look, "", 0, 1, "Moving the hand forward looks down"),
         SUNFLECK_FIELD(DemoSettings, frame_cap, "1/s", 10, 1000, "Most pictures a second"),
         SUNFLECK_FIELD(DemoSettings, vertical_sync, "", 0, 1, "Waits for the screen, so that no picture is torn"),
         SUNFLECK_FIELD(DemoSettings, full_screen, "", 0, 1, "Fills the monitor"),
         SUNFLECK_FIELD(DemoSettings, show_times, "", 0, 1, "Shows what each part of a frame takes"),
         SUNFLECK_FIELD(DemoSettings, letter_scale, "", 0.5, 3, "Size of letters and menus")}};
    return type;
}

std::filesystem::path settings_path() {
    if (const char* folder = std::getenv("XDG_CONFIG_HOME"); folder != nullptr && folder[0] == '/')
        return std::filesystem::path(folder) / "sunfleck/demo.json";
    const char* home = std::getenv("HOME");
    return std::filesystem::path(home != nullptr ? home : "/tmp") / ".config/sunfleck/demo.json";
}

LoadedSettings load_settings(const std::filesystem::path& path) {
    LoadedSettings result;
    std::error_code code;
    if (!std::filesystem::exists(path, code))
        return result;
    result.found = true;
    const auto text = read_file(path, 1u << 20);
    const nlohmann::json file =
        text ? nlohmann::json::parse(*text, nullptr, false) : nlohmann::json(nlohmann::json::value_t::discarded);
    if (file.is_discarded() || !file.is_object()) {
        result.problem = "'" + path.string() + "' is damaged; the usual settings are used";
        std::filesystem::rename(path, path.string() + ".damaged", code);
        return result;
    }
    for (const Field& field : DemoSettings::description().fields) {
        const auto value = file.find(std::string(field.name));
        if (value == file.end())
            continue;
        const std::string words = value->is_string() ? value->get<std::string>() : value->dump();
        if (const Status status = field_from_text(field, &result.settings, words); !status)
            result.problem = "'" + path.string() + "': " + status.error().message;
    }
    const auto bindings = file.find("bindings");
    if (bindings == file.end() || !bindings->is_object())
        return result;
    for (std::size_t i = 0; i < action_count; ++i) {
        const auto value = bindings->find(actions[i].name);
        if (value == bindings->end() || !value->is_string())
            continue;
        const app::Key key = app::key_by_name(value->get<std::string>());
        if (key == app::no_key)
            result.problem = "'" + path.string() + "': there is no key called '" + value->get<std::string>() + "'";
        else
            result.settings.bindings[i] = key;
    }
    return result;
}

Status save_settings(const std::filesystem::path& path, const DemoSettings& settings) {
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
    std::error_code code;
    std::filesystem::create_directories(path.parent_path(), code);
    return write_file(path, file.dump(2) + "\n");
}

} // namespace sunfleck::demo

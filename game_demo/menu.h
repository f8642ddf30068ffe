// The user interface: title, pause, settings, help, prompts, frame times. Calls Dear ImGui between Gui::begin_frame and
// end_frame; the player's choice is returned as a Decision.
#pragma once

#include "engine/simulation/simulation.h"
#include "game_demo/demo_settings.h"

#include <map>
#include <optional>

namespace sunfleck::demo {

enum class Screen { title, playing, paused, settings, help, finished };
// "title", "playing", "paused", ...
const char* screen_name(Screen screen);
enum class Decision { none, play, resume, restart, hint, reset_room, title, quit };

// Data for the overlays.
struct OverlayData {
    simulation::Interaction interaction = simulation::Interaction::none;
    bool carries_lantern = false, indirect_light = true;
    double frame_ms = 0.0;
    std::map<std::string, double> gpu_ms, cpu_ms;
    std::uint64_t light_samples = 0;
    std::uint32_t rendered_width = 0, rendered_height = 0;
    std::optional<float> light_share; // how far a change of light is, 0 to 1; none: there is none
    std::string device;
    bool is_game = false, can_resume = false; // the level has areas or a goal; there is a checkpoint
    bool has_area = false, has_hint = false;  // the person is in one; it has a hint
    bool with_gamepad = false;                // the person plays with one
    double game_seconds = 0.0;
};

class Menu {
public:
    Screen screen() const { return screen_; }
    // Settings and help lead back to the screen that they were opened from.
    void show(Screen screen);
    // Escape or the gamepad's start button; in menus, its B button.
    void back();
    // Draws and applies changes to `settings` immediately. `changed`: at least one setting changed.
    Decision draw(DemoSettings& settings, const OverlayData& data, const app::InputState& input, bool& changed);
    // Replaces draw while a level loads. `share`: fraction done, 0 to 1.
    static void loading_screen(float share);
    // Shows a message at the top for a few seconds; an empty one is none.
    void say(std::string message, double seconds = 3.5);
    // The button that the keyboard or gamepad has selected; empty: none.
    const std::string& selected() const { return selected_; }
    // What is said now.
    std::string message_text() const { return message_seconds_ > 0.0 ? message_ : std::string(); }

private:
    // With a question, which then stands in place of the label, it takes two presses.
    bool wide_button(const char* label, const char* question = nullptr);
    Decision title_screen(const OverlayData& data, bool enter);
    Decision pause_screen(const OverlayData& data, bool enter);
    Decision end_screen(const OverlayData& data, bool enter);
    void settings_and_help_buttons();
    void settings_screen(DemoSettings& settings, const app::InputState& input, bool& changed);
    void settings_tabs(DemoSettings& settings, const app::InputState& input, bool& changed);
    void help_screen(const DemoSettings& settings, bool is_game);
    void prompts(const DemoSettings& settings, const OverlayData& data);
    static void direct_light_label(const DemoSettings& settings, const OverlayData& data);
    void times(const OverlayData& data);
    void message();
    static void light_progress(float share);
    bool field(DemoSettings& settings, const char* name, const char* label);
    void image_tab(DemoSettings& settings, bool& changed);
    void display_tab(DemoSettings& settings, bool& changed);
    void bindings_tab(DemoSettings& settings, const app::InputState& input, bool& changed);

    Screen screen_ = Screen::title, came_from_ = Screen::title;
    int rebinding_ = -1;                 // action that is waiting for a key
    std::optional<float> dragged_scale_; // of text, while its slider is held: the slider must not move meanwhile
    std::string selected_, asked_;
    std::string message_;
    double message_seconds_ = 0.0;
    bool a_is_down_ = false, b_is_down_ = false; // of the gamepad
    bool popup_was_open_ = false;                // in the last frame
};

} // namespace sunfleck::demo

#include "game_demo/menu.h"

#include "game_demo/gui_parts.h"
#include "game_demo/presets.h"
#include "game_demo/prompt_text.h"

#include <algorithm>
#include <utility>

namespace sunfleck::demo {
namespace {

constexpr int pad_a = 0, pad_b = 1;

bool choice_box(const Field& field, const char* label, std::uint32_t& value) {
    if (!ImGui::BeginCombo(label, std::string(field.choices[value]).c_str()))
        return false;
    bool changed = false;
    for (std::uint32_t i = 0; i < field.choices.size(); ++i)
        if (ImGui::Selectable(std::string(field.choices[i]).c_str(), i == value)) {
            value = i;
            changed = true;
        }
    ImGui::EndCombo();
    return changed;
}

bool slider(const Field& field, const char* label, char* place) {
    const std::string unit_text(field.unit);
    if (field.kind == FieldKind::unsigned_integer) {
        const auto low = std::uint32_t(field.minimum), high = std::uint32_t(field.maximum);
        return ImGui::SliderScalar(label, ImGuiDataType_U32, place, &low, &high, ("%u " + unit_text).c_str(),
                                   ImGuiSliderFlags_AlwaysClamp | ImGuiSliderFlags_Logarithmic);
    }
    return ImGui::SliderFloat(label, reinterpret_cast<float*>(place), float(field.minimum), float(field.maximum),
                              ("%.2f " + unit_text).c_str(), ImGuiSliderFlags_AlwaysClamp);
}

// One size for all tabs, so that they stay under the pointer: room for the longest one, which otherwise scrolls.
ImVec2 settings_size() {
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    constexpr float rows = 15.0f; // heading, tabs, two sliders, nine rows of keys, gamepad, buttons
    const float height = rows * ImGui::GetFrameHeightWithSpacing() + 2.0f * unit();
    return {std::min(36.0f * unit(), 0.96f * screen.x), std::min(height, 0.96f * screen.y)};
}

} // namespace

const char* screen_name(Screen screen) {
    constexpr const char* names[] = {"title", "playing", "paused", "settings", "help", "finished"};
    return names[std::size_t(screen)];
}

bool Menu::wide_button(const char* label, const char* question) {
    const bool asked = question != nullptr && asked_ == label;
    const std::string shown = question == nullptr ? label : std::string(asked ? question : label) + "###" + label;
    const bool pressed = ImGui::Button(shown.c_str(), ImVec2(13.0f * unit(), 0.0f));
    if (ImGui::IsItemFocused())
        selected_ = label;
    else if (asked && !ImGui::IsItemHovered())
        asked_.clear(); // the player has gone on to another
    if (pressed)
        asked_ = asked ? "" : label;
    return pressed && (asked || question == nullptr);
}

void Menu::say(std::string message, double seconds) {
    if (message.empty())
        return;
    message_ = std::move(message);
    message_seconds_ = seconds;
}

void Menu::show(Screen screen) {
    const bool leads_back = screen == Screen::settings || screen == Screen::help;
    const bool from_main = screen_ != Screen::settings && screen_ != Screen::help;
    if (leads_back && from_main)
        came_from_ = screen_;
    asked_.clear();
    screen_ = screen;
}

void Menu::back() {
    if (rebinding_ >= 0) {
        rebinding_ = -1;
        return;
    }
    switch (screen_) {
    case Screen::playing:
        screen_ = Screen::paused;
        break;
    case Screen::paused:
        screen_ = Screen::playing;
        break;
    case Screen::settings:
    case Screen::help:
        screen_ = came_from_;
        break;
    case Screen::title:
    case Screen::finished:
        break;
    }
}

Decision Menu::draw(DemoSettings& settings, const OverlayData& data, const app::InputState& input, bool& changed) {
    changed = false;
    selected_.clear();
    // Until keyboard or gamepad navigation has selected something, Enter or A activates the first entry.
    const bool a_before = std::exchange(a_is_down_, input.gamepad.pressed(pad_a));
    const bool enter = (input.hit(app::key_enter) || (a_is_down_ && !a_before)) && !ImGui::GetIO().NavVisible;
    // A list of choices that is open takes B itself.
    const bool b_before = std::exchange(b_is_down_, input.gamepad.pressed(pad_b));
    if (b_is_down_ && !b_before && screen_ != Screen::playing && !popup_was_open_)
        back();
    Decision decision = Decision::none;
    switch (screen_) {
    case Screen::title:
        decision = title_screen(data, enter);
        break;
    case Screen::paused:
        decision = pause_screen(data, enter);
        break;
    case Screen::settings:
        settings_screen(settings, input, changed);
        break;
    case Screen::help:
        help_screen(settings, data.is_game);
        break;
    case Screen::finished:
        decision = end_screen(data, enter);
        break;
    case Screen::playing:
        prompts(settings, data);
        break;
    }
    if (settings.show_times)
        times(data);
    popup_was_open_ = ImGui::IsPopupOpen(nullptr, ImGuiPopupFlags_AnyPopupId | ImGuiPopupFlags_AnyPopupLevel);
    message();
    if (data.light_share)
        light_progress(*data.light_share);
    return decision;
}

void Menu::settings_and_help_buttons() {
    if (wide_button("Settings"))
        show(Screen::settings);
    if (wide_button("Help"))
        show(Screen::help);
}

// The widget of one described field of `settings`; true if the value changed.
bool Menu::field(DemoSettings& settings, const char* name, const char* label) {
    const Field* described = DemoSettings::description().find(name);
    if (described == nullptr)
        return false;
    char* place = reinterpret_cast<char*>(&settings) + described->offset;
    ImGui::SetNextItemWidth(12.0f * unit());
    bool changed = false;
    if (described->kind == FieldKind::boolean)
        changed = ImGui::Checkbox(label, reinterpret_cast<bool*>(place));
    else if (described->kind == FieldKind::choice)
        changed = choice_box(*described, label, *reinterpret_cast<std::uint32_t*>(place));
    else
        changed = slider(*described, label, place);
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip("%s", std::string(described->tooltip).c_str());
    return changed;
}

void Menu::image_tab(DemoSettings& settings, bool& changed) {
    if (field(settings, "preset", "Quality")) {
        apply_preset(settings);
        changed = true;
    }
    bool custom = false; // each of them is drawn
    custom |= field(settings, "render_scale", "Render scale");
    custom |= field(settings, "light_samples", "Light samples");
    custom |= field(settings, "map_budget", "Shadow maps");
    custom |= field(settings, "transfer", "Precomputed radiance transfer");
    if (custom)
        settings.preset = Preset::custom;
    changed |= custom;
    changed |= field(settings, "antialiasing", "Anti-aliasing");
    if (settings.antialiasing)
        changed |= field(settings, "temporal", "Temporal anti-aliasing");
    changed |= field(settings, "glare", "Glare");
    changed |= field(settings, "exposure", "Exposure");
    changed |= field(settings, "adaptation", "Adaptation of the eye");
    changed |= field(settings, "field_of_view", "Field of view");
}

void Menu::display_tab(DemoSettings& settings, bool& changed) {
    for (const auto& [name, label] :
         {std::pair("full_screen", "Full screen"), std::pair("vertical_sync", "Vertical sync"),
          std::pair("frame_cap", "Frame limit"), std::pair("frame_milliseconds", "Frame time to hold"),
          std::pair("show_times", "Frame times")})
        changed |= field(settings, name, label);
    DemoSettings dragged = settings;
    dragged.ui_scale = dragged_scale_.value_or(settings.ui_scale);
    if (field(dragged, "ui_scale", "Text size"))
        dragged_scale_ = dragged.ui_scale;
    if (dragged_scale_ && !ImGui::IsItemActive()) {
        settings.ui_scale = *dragged_scale_;
        dragged_scale_.reset();
        changed = true;
    }
}

void Menu::settings_tabs(DemoSettings& settings, const app::InputState& input, bool& changed) {
    if (!ImGui::BeginTabBar("tabs"))
        return;
    const auto tab = [](const char* label, const auto& content) {
        if (!ImGui::BeginTabItem(label))
            return;
        ImGui::BeginChild(label, ImVec2(0.0f, -ImGui::GetFrameHeightWithSpacing()));
        content();
        ImGui::EndChild();
        ImGui::EndTabItem();
    };
    tab("Image", [&] { image_tab(settings, changed); });
    tab("Display", [&] { display_tab(settings, changed); });
    tab("Sound", [&] {
        changed |= field(settings, "volume", "Volume");
        changed |= field(settings, "subtitles", "Subtitles");
    });
    tab("Controls", [&] { bindings_tab(settings, input, changed); });
    ImGui::EndTabBar();
}

void Menu::settings_screen(DemoSettings& settings, const app::InputState& input, bool& changed) {
    place_next(0.5f, 0.5f, 0.5f, 0.5f);
    ImGui::SetNextWindowSize(settings_size());
    ImGui::Begin("settings", nullptr, plain & ~ImGuiWindowFlags_AlwaysAutoResize);
    heading("Settings", 1.4f);
    settings_tabs(settings, input, changed);
    if (wide_button("Back"))
        back();
    ImGui::SameLine();
    if (ImGui::Button("Reset to defaults")) {
        const Preset preset = settings.preset;
        settings = DemoSettings();
        settings.preset = preset == Preset::custom ? Preset::software : preset;
        apply_preset(settings);
        changed = true;
    }
    ImGui::End();
}

void Menu::bindings_tab(DemoSettings& settings, const app::InputState& input, bool& changed) {
    changed |= field(settings, "sensitivity", "Look sensitivity");
    changed |= field(settings, "invert_look", "Invert vertical look");
    if (rebinding_ >= 0 && !input.went_down.empty() && input.went_down.front() != app::first_mouse_button) {
        const app::Key key = input.went_down.front();
        if (key != app::key_escape) {
            // Each key has one action: the action that had this key gets the old one.
            for (app::Key& other : settings.bindings)
                if (other == key)
                    other = settings.bindings[std::size_t(rebinding_)];
            settings.bindings[std::size_t(rebinding_)] = key;
            changed = true;
        }
        rebinding_ = -1;
    }
    for (std::size_t i = 0; i < action_count; ++i) {
        ImGui::PushID(int(i));
        const bool waiting = rebinding_ == int(i);
        if (ImGui::Button(waiting ? "press a key" : app::key_name(settings.bindings[i]).c_str(),
                          ImVec2(8.0f * unit(), 0.0f)))
            rebinding_ = waiting ? -1 : int(i);
        ImGui::SameLine();
        ImGui::TextUnformatted(action_label(Action(i)));
        ImGui::PopID();
        if (i % 2 == 0 && i + 1 < action_count)
            ImGui::SameLine(20.0f * unit());
    }
    ImGui::TextDisabled("%s", input.gamepad.present ? ("Gamepad: " + input.gamepad.name).c_str() : "No gamepad");
}

// Four keys, one line.
static bool is_look(Action action) {
    return action >= Action::look_left && action <= Action::look_down;
}

void Menu::help_screen(const DemoSettings& settings, bool is_game) {
    place_next(0.5f, 0.5f, 0.5f, 0.5f);
    ImGui::Begin("help", nullptr, plain);
    heading("Help", 1.4f);
    const auto line = [](const std::string& keys, const char* what) {
        ImGui::TextColored(ImVec4(0.95f, 0.70f, 0.35f, 1.0f), "%s", keys.c_str());
        ImGui::SameLine(
            std::max(7.0f * unit(), ImGui::GetItemRectSize().x + ImGui::GetStyle().WindowPadding.x + unit()));
        ImGui::TextUnformatted(what);
    };
    std::string look;
    for (std::size_t i = 0; i < action_count; ++i) {
        if (!is_look(Action(i)))
            line(key_of(settings, Action(i)), action_label(Action(i)));
        else if (look += " " + key_of(settings, Action(i)); Action(i) == Action::look_down)
            line(look.substr(1), "Look, as by the mouse");
    }
    line("escape", "Pause; back");
    ImGui::Dummy(ImVec2(0.0f, 0.4f * unit()));
    ImGui::TextUnformatted("Gamepad: left stick: walk; right stick: look; A: use; B: crouch;\n"
                           "X: put down; Y: indirect light; left bumper: run; Start: pause.\n\n"
                           "In the menus, D-pad or arrows choose, A or Enter takes, B or Escape goes back.");
    ImGui::TextUnformatted(help_text(is_game));
    if (wide_button("Back"))
        back();
    ImGui::SetItemDefaultFocus();
    ImGui::End();
}

} // namespace sunfleck::demo

#include "game_demo/menu.h"

#include "game_demo/presets.h"

#include <algorithm>
#include <cstdio>
#include <imgui.h>

namespace sunfleck::demo {
namespace {

constexpr ImGuiWindowFlags plain = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                                   ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings;
constexpr ImGuiWindowFlags behind =
    plain | ImGuiWindowFlags_NoInputs | ImGuiWindowFlags_NoNav | ImGuiWindowFlags_NoFocusOnAppearing;

void place_next(float x, float y, float pivot_x, float pivot_y) {
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos(ImVec2(x * size.x, y * size.y), ImGuiCond_Always, ImVec2(pivot_x, pivot_y));
}

float unit() {
    return ImGui::GetFontSize();
}

bool wide_button(const char* label) {
    return ImGui::Button(label, ImVec2(13.0f * unit(), 0.0f));
}

void heading(const char* text, float scale) {
    ImGui::SetWindowFontScale(scale);
    ImGui::TextUnformatted(text);
    ImGui::SetWindowFontScale(1.0f);
}

const char* verb(simulation::Interaction interaction) {
    switch (interaction) {
    case simulation::Interaction::open:
        return "open the door";
    case simulation::Interaction::close:
        return "close the door";
    case simulation::Interaction::switch_lamps:
        return "switch the lamp";
    case simulation::Interaction::take:
        return "take the lantern";
    case simulation::Interaction::none:
        break;
    }
    return "";
}

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

std::string key_of(const DemoSettings& settings, Action action) {
    return app::key_name(settings.bindings[std::size_t(action)]);
}

} // namespace

void Menu::say(std::string message, double seconds) {
    message_ = std::move(message);
    message_seconds_ = seconds;
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
        break;
    }
}

Decision Menu::draw(DemoSettings& settings, const OverlayData& data, const app::InputState& input, bool& changed) {
    changed = false;
    // Until keyboard or gamepad navigation has selected something, Enter activates the first entry.
    const bool enter = input.hit(app::key_enter) && !ImGui::GetIO().NavVisible;
    Decision decision = Decision::none;
    switch (screen_) {
    case Screen::title:
        decision = title_screen(enter);
        break;
    case Screen::paused:
        decision = pause_screen(enter);
        break;
    case Screen::settings:
        settings_screen(settings, input, changed);
        break;
    case Screen::help:
        help_screen(settings);
        break;
    case Screen::playing:
        prompts(settings, data);
        break;
    }
    if (settings.show_times)
        times(data);
    message();
    return decision;
}

void Menu::settings_and_help_buttons() {
    const Screen from = screen_;
    if (wide_button("Settings"))
        screen_ = Screen::settings;
    if (wide_button("Help"))
        screen_ = Screen::help;
    if (screen_ != from)
        came_from_ = from;
}

// Drawn without a window: ImGui needs a frame to find a window's size, and this may be the only frame.
void Menu::loading_screen(float share) {
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    ImDrawList* list = ImGui::GetForegroundDrawList();
    const auto line = [&](const char* text, float height, float scale, ImU32 colour) {
        const float wide = scale * ImGui::CalcTextSize(text).x;
        list->AddText(ImGui::GetFont(), scale * unit(), ImVec2(0.5f * (size.x - wide), height * size.y), colour, text);
    };
    line("Lantern House", 0.42f, 1.9f, IM_COL32(255, 214, 150, 255));
    line("Computing light paths ...", 0.52f, 1.0f, IM_COL32(220, 210, 195, 255));
    const ImVec2 low(0.36f * size.x, 0.6f * size.y), high(0.64f * size.x, low.y + 0.25f * unit());
    list->AddRectFilled(low, high, IM_COL32(56, 46, 36, 255), 0.1f * unit());
    if (share > 0.0f)
        list->AddRectFilled(low, ImVec2(low.x + share * (high.x - low.x), high.y), IM_COL32(234, 158, 61, 255),
                            0.1f * unit());
    line("Press Escape to quit", 0.66f, 0.8f, IM_COL32(150, 142, 130, 255));
}

Decision Menu::title_screen(bool enter) {
    Decision decision = Decision::none;
    place_next(0.08f, 0.5f, 0.0f, 0.5f);
    ImGui::Begin("title", nullptr, plain);
    heading("Lantern House", 1.9f);
    ImGui::TextUnformatted("A Sunfleck demo of indirect light");
    ImGui::Dummy(ImVec2(0.0f, 0.6f * unit()));
    if (wide_button("Start") || enter)
        decision = Decision::play;
    ImGui::SetItemDefaultFocus();
    settings_and_help_buttons();
    if (wide_button("Quit"))
        decision = Decision::quit;
    ImGui::End();
    return decision;
}

Decision Menu::pause_screen(bool enter) {
    Decision decision = Decision::none;
    place_next(0.5f, 0.5f, 0.5f, 0.5f);
    ImGui::Begin("paused", nullptr, plain);
    heading("Paused", 1.4f);
    if (wide_button("Resume") || enter)
        decision = Decision::play;
    ImGui::SetItemDefaultFocus();
    settings_and_help_buttons();
    if (wide_button("Restart"))
        decision = Decision::restart;
    if (wide_button("Quit"))
        decision = Decision::quit;
    ImGui::End();
    return decision;
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
    const bool custom =
        field(settings, "render_scale", "Render scale") | field(settings, "light_samples", "Light samples") |
        field(settings, "map_budget", "Shadow maps") | field(settings, "transfer", "Precomputed radiance transfer");
    if (custom)
        settings.preset = Preset::custom;
    changed |= custom;
    changed |= field(settings, "exposure", "Exposure");
    changed |= field(settings, "field_of_view", "Field of view");
}

void Menu::display_tab(DemoSettings& settings, bool& changed) {
    for (const auto& [name, label] :
         {std::pair("full_screen", "Full screen"), std::pair("vertical_sync", "Vertical sync"),
          std::pair("frame_cap", "Frame limit"), std::pair("show_times", "Frame times"),
          std::pair("ui_scale", "Text size")})
        changed |= field(settings, name, label);
}

void Menu::settings_screen(DemoSettings& settings, const app::InputState& input, bool& changed) {
    place_next(0.5f, 0.5f, 0.5f, 0.5f);
    ImGui::Begin("settings", nullptr, plain);
    heading("Settings", 1.4f);
    if (ImGui::BeginTabBar("tabs")) {
        if (ImGui::BeginTabItem("Image")) {
            image_tab(settings, changed);
            ImGui::EndTabItem();
        }
        if (ImGui::BeginTabItem("Display")) {
            display_tab(settings, changed);
            ImGui::EndTabItem();
        }
        if (ImGui::BeginTabItem("Controls")) {
            bindings_tab(settings, input, changed);
            ImGui::EndTabItem();
        }
        ImGui::EndTabBar();
    }
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

void Menu::help_screen(const DemoSettings& settings) {
    place_next(0.5f, 0.5f, 0.5f, 0.5f);
    ImGui::Begin("help", nullptr, plain);
    heading("Help", 1.4f);
    for (std::size_t i = 0; i < action_count; ++i) {
        ImGui::TextColored(ImVec4(0.95f, 0.70f, 0.35f, 1.0f), "%s", key_of(settings, Action(i)).c_str());
        ImGui::SameLine(7.0f * unit());
        ImGui::TextUnformatted(action_label(Action(i)));
    }
    ImGui::TextColored(ImVec4(0.95f, 0.70f, 0.35f, 1.0f), "escape");
    ImGui::SameLine(7.0f * unit());
    ImGui::TextUnformatted("Pause; back");
    ImGui::Dummy(ImVec2(0.0f, 0.4f * unit()));
    ImGui::TextUnformatted("Gamepad: left stick: walk; right stick: look; A: use; B: crouch;\n"
                           "X: put down; Y: indirect light; left bumper: run; Start: pause.\n\n"
                           "Walk into balls and crates to push them. The lift in the green room\n"
                           "leads to the attic. Switches beside the doors turn lamps on and off.");
    if (wide_button("Back"))
        back();
    ImGui::SetItemDefaultFocus();
    ImGui::End();
}

void Menu::prompts(const DemoSettings& settings, const OverlayData& data) {
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    ImDrawList* list = ImGui::GetForegroundDrawList();
    const bool target = data.interaction != simulation::Interaction::none;
    list->AddCircleFilled(ImVec2(0.5f * size.x, 0.5f * size.y), target ? 0.22f * unit() : 0.12f * unit(),
                          target ? IM_COL32(255, 196, 110, 220) : IM_COL32(255, 255, 255, 130));
    std::string text;
    if (target)
        text = key_of(settings, Action::use) + "  " + verb(data.interaction);
    else if (data.carries_lantern)
        text = key_of(settings, Action::put_down) + "  put down the lantern";
    if (text.empty())
        return;
    place_next(0.5f, 0.94f, 0.5f, 1.0f);
    ImGui::SetNextWindowBgAlpha(0.45f);
    ImGui::Begin("prompt", nullptr, behind);
    ImGui::TextUnformatted(text.c_str());
    ImGui::End();
}

void Menu::times(const OverlayData& data) {
    place_next(0.99f, 0.02f, 1.0f, 0.0f);
    ImGui::SetNextWindowBgAlpha(0.6f);
    ImGui::Begin("times", nullptr, behind);
    ImGui::Text("%.0f ms, %.1f frames per second", data.frame_ms, data.frame_ms > 0.0 ? 1000.0 / data.frame_ms : 0.0);
    ImGui::Text("%u x %u, %llu light samples", data.rendered_width, data.rendered_height,
                static_cast<unsigned long long>(data.light_samples));
    ImGui::TextDisabled("%s", data.device.c_str());
    double longest = 1e-6;
    for (const auto* group : {&data.gpu_ms, &data.cpu_ms})
        for (const auto& [name, time] : *group)
            longest = std::max(longest, time);
    const auto rows = [&](const char* title, const std::map<std::string, double>& group) {
        ImGui::TextDisabled("%s, ms", title);
        for (const auto& [name, time] : group) {
            if (time < 0.05)
                continue;
            char number[32];
            std::snprintf(number, sizeof number, "%.1f", time);
            ImGui::ProgressBar(float(time / longest), ImVec2(7.0f * unit(), 0.9f * unit()), number);
            ImGui::SameLine();
            ImGui::TextUnformatted(name.c_str());
        }
    };
    rows("GPU passes", data.gpu_ms);
    rows("CPU stages", data.cpu_ms);
    ImGui::End();
}

void Menu::message() {
    if (message_seconds_ <= 0.0)
        return;
    message_seconds_ -= double(ImGui::GetIO().DeltaTime);
    place_next(0.5f, 0.05f, 0.5f, 0.0f);
    ImGui::SetNextWindowBgAlpha(0.6f);
    ImGui::Begin("message", nullptr, behind);
    ImGui::TextUnformatted(message_.c_str());
    ImGui::End();
}

} // namespace sunfleck::demo

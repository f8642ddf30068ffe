// What menus and overlays share: windows of Dear ImGui, places, units.
#pragma once

#include "game_demo/demo_settings.h"

#include <imgui.h>

namespace sunfleck::demo {

inline constexpr ImGuiWindowFlags plain = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                                          ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings;
inline constexpr ImGuiWindowFlags behind =
    plain | ImGuiWindowFlags_NoInputs | ImGuiWindowFlags_NoNav | ImGuiWindowFlags_NoFocusOnAppearing;

// `x` and `y`: shares of the screen; the pivot lies there.
inline void place_next(float x, float y, float pivot_x, float pivot_y) {
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos(ImVec2(x * size.x, y * size.y), ImGuiCond_Always, ImVec2(pivot_x, pivot_y));
}

// The height of text.
inline float unit() {
    return ImGui::GetFontSize();
}

inline void heading(const char* text, float scale) {
    ImGui::SetWindowFontScale(scale);
    ImGui::TextUnformatted(text);
    ImGui::SetWindowFontScale(1.0f);
}

inline std::string key_of(const DemoSettings& settings, Action action) {
    return app::key_name(settings.bindings[std::size_t(action)]);
}

} // namespace sunfleck::demo

// How the editor looks: dark and neutral, so that colours of the scene are judged, not those around it.
#pragma once

#include <imgui.h>

namespace sunfleck::editor {

inline void set_style(ImGuiStyle& style) {
    style.WindowPadding = ImVec2(8.0f, 6.0f);
    style.FramePadding = ImVec2(6.0f, 3.0f);
    style.ItemSpacing = ImVec2(6.0f, 4.0f);
    style.CellPadding = ImVec2(3.0f, 2.0f);
    style.ScrollbarSize = 12.0f;
    style.FrameRounding = style.GrabRounding = 3.0f;
    style.Colors[ImGuiCol_WindowBg] = style.Colors[ImGuiCol_ChildBg] = ImVec4(0.105f, 0.10f, 0.095f, 1.0f);
    style.Colors[ImGuiCol_MenuBarBg] = ImVec4(0.14f, 0.13f, 0.12f, 1.0f);
    style.Colors[ImGuiCol_PopupBg] = ImVec4(0.13f, 0.125f, 0.12f, 1.0f);
    style.Colors[ImGuiCol_FrameBg] = style.Colors[ImGuiCol_Button] = ImVec4(0.20f, 0.185f, 0.165f, 1.0f);
    style.Colors[ImGuiCol_Header] = ImVec4(0.33f, 0.24f, 0.13f, 1.0f);
    style.Colors[ImGuiCol_TextDisabled] = ImVec4(0.62f, 0.60f, 0.57f, 1.0f);
    style.Colors[ImGuiCol_Tab] = ImVec4(0.16f, 0.15f, 0.14f, 1.0f);
    style.Colors[ImGuiCol_TitleBg] = style.Colors[ImGuiCol_TitleBgActive] = ImVec4(0.33f, 0.24f, 0.13f, 1.0f);
    style.Colors[ImGuiCol_ModalWindowDimBg] = ImVec4(0.0f, 0.0f, 0.0f, 0.55f);
    style.Colors[ImGuiCol_TabActive] = ImVec4(0.40f, 0.28f, 0.13f, 1.0f);
}

} // namespace sunfleck::editor

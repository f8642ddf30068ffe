#include "editor/window/comparison_overlay.h"

#include "editor/window/comparison.h"
#include "editor/window/heat_map.h"
#include "editor/window/widgets.h"

#include <algorithm>

namespace sunfleck::editor {
namespace {

// At the lower edge, from x on.
void label(const ImVec4& area, float x, const std::string& text) {
    ImDrawList* list = ImGui::GetWindowDrawList();
    const ImVec2 size = ImGui::CalcTextSize(text.c_str()), low(x, area.y + area.w - 1.8f * ui::unit());
    list->AddRectFilled(ImVec2(low.x - 4.0f, low.y - 2.0f), ImVec2(low.x + size.x + 4.0f, low.y + size.y + 2.0f),
                        IM_COL32(20, 18, 16, 200), 3.0f);
    list->AddText(low, IM_COL32(255, 255, 255, 255), text.c_str());
}

// What the colours of errors mean, above the labels, to the right.
void heat_legend(const ImVec4& area) {
    constexpr int bands = 32;
    const float width = std::min(10.0f * ui::unit(), 0.4f * area.z), height = 0.6f * ui::unit();
    const ImVec2 low(area.x + area.z - width - ui::unit(), area.y + area.w - 3.4f * ui::unit());
    ImDrawList* list = ImGui::GetWindowDrawList();
    for (int i = 0; i < bands; ++i) {
        const vec3 colour = 255.0f * heat_colour((float(i) + 0.5f) / float(bands));
        list->AddRectFilled(ImVec2(low.x + width * float(i) / float(bands), low.y),
                            ImVec2(low.x + width * float(i + 1) / float(bands), low.y + height),
                            IM_COL32(int(colour.r), int(colour.g), int(colour.b), 255));
    }
    list->AddRect(low, ImVec2(low.x + width, low.y + height), IM_COL32(255, 255, 255, 120));
    const std::string end = ui::number_text(double(heat_end), false);
    const auto write = [&](float x, const std::string& text) {
        list->AddText(ImVec2(x, low.y - ImGui::GetFontSize() - 2.0f), IM_COL32(255, 255, 255, 255), text.c_str());
    };
    write(low.x, "0");
    write(low.x + width - ImGui::CalcTextSize(end.c_str()).x, end);
}

} // namespace

bool draw_comparison(Session& session) {
    Comparison& comparison = *session.comparison;
    if (!comparison.on())
        return false;
    const ImVec4 area = session.viewport_area;
    const std::string one = comparison.name_of_one(), other = comparison.name_of_other();
    if (comparison.as != CompareAs::split) {
        const bool as_error = comparison.as == CompareAs::difference, as_heat = comparison.as == CompareAs::heat;
        label(area, area.x + ui::unit(),
              as_error             ? "8 x error of " + one + " against " + other
              : as_heat            ? "error of " + one + " against " + other
              : comparison.flipped ? other
                                   : one);
        if (as_heat)
            heat_legend(area);
        return false;
    }
    const float x = area.x + comparison.split * area.z;
    ImGui::GetWindowDrawList()->AddLine(ImVec2(x, area.y), ImVec2(x, area.y + area.w), IM_COL32(255, 255, 255, 200),
                                        1.5f);
    label(area, std::max(x - ImGui::CalcTextSize(one.c_str()).x - ui::unit(), area.x + 4.0f), one);
    label(area, x + ui::unit(), other);
    ImGui::SetCursorScreenPos(ImVec2(x - 5.0f, area.y + 3.0f * ui::unit()));
    ImGui::InvisibleButton("split", ImVec2(10.0f, std::max(area.w - 6.0f * ui::unit(), 1.0f)));
    ui::note("split", ui::number_text(double(comparison.split), false));
    if (ImGui::IsItemActive())
        comparison.split = std::clamp((ImGui::GetIO().MousePos.x - area.x) / area.z, 0.02f, 0.98f);
    if (ImGui::IsItemHovered() || ImGui::IsItemActive())
        ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
    return ImGui::IsItemHovered() || ImGui::IsItemActive();
}

} // namespace sunfleck::editor

// A number: dragged sideways, or clicked and typed.
#include "editor/window/widgets.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <imgui_internal.h>
#include <imgui_stdlib.h>

namespace sunfleck::editor::ui {
namespace {

using Phase = NumberEdit::Phase;
constexpr float drag_threshold = 3.0f; // pixels, from which on a click is a drag

struct BoxState {
    ImGuiID typing = 0, dragging = 0;
    int frames = 0;       // since typing began
    bool to_next = false; // Tab: the next box is typed into
    bool seen = false;    // the box that is typed into or dragged was drawn in this frame
    std::string text, before;
    double start = 0.0;
};

BoxState& state() {
    static BoxState only;
    return only;
}

void begin_typing(ImGuiID id, const NumberLook& look) {
    ask_for_quiet_frames();
    state().typing = id;
    state().seen = true;
    state().frames = 0;
    state().text = state().before = look.mixed ? "" : number_text(look.value, look.whole);
}

NumberEdit typed_box(const std::string& name, const NumberLook& look) {
    BoxState& box = state();
    if (box.frames++ == 0)
        ImGui::SetKeyboardFocusHere();
    ImGui::SetNextItemWidth(look.width);
    const bool enter = ImGui::InputText(("##" + name).c_str(), &box.text,
                                        ImGuiInputTextFlags_AutoSelectAll | ImGuiInputTextFlags_EnterReturnsTrue);
    note(name, box.text);
    const bool escape = ImGui::IsKeyPressed(ImGui::GetIO().KeyMap[ImGuiKey_Escape], false);
    const bool left = box.frames > 2 && !ImGui::IsItemActive();
    if (!enter && !left && !escape)
        return {};
    box.to_next = ImGui::IsKeyPressed(ImGui::GetIO().KeyMap[ImGuiKey_Tab], false) && !enter;
    box.typing = 0;
    if (escape || box.text == box.before)
        return {};
    return {Phase::typed, 0.0, box.text};
}

// How far a pixel goes: relative to the value, or to a range that is small.
double dragged_value(const NumberLook& look, double start, float pixels) {
    const double range = look.maximum - look.minimum;
    const bool bounded = range > 0.0 && range <= 400.0;
    double speed = look.speed > 0.0 ? look.speed : bounded ? range / 400.0 : std::max(std::abs(start), 1.0) * 0.01;
    if (ImGui::GetIO().KeyShift)
        speed *= 0.1;
    const double value = start + speed * double(pixels);
    const double limited = look.maximum > look.minimum ? std::clamp(value, look.minimum, look.maximum) : value;
    return look.whole ? std::round(limited) : limited;
}

NumberEdit drag(ImGuiID id, const NumberLook& look) {
    BoxState& box = state();
    if (box.dragging != id) {
        if (std::abs(ImGui::GetMouseDragDelta(0, 0.0f).x) < drag_threshold)
            return {};
        box.dragging = id;
        box.seen = true;
        box.start = look.value;
        return {Phase::began, look.value, {}};
    }
    if (ImGui::IsKeyPressed(ImGui::GetIO().KeyMap[ImGuiKey_Escape], false)) {
        box.dragging = 0;
        ImGui::ClearActiveID();
        return {Phase::cancelled, 0.0, {}};
    }
    return {Phase::dragged, dragged_value(look, box.start, ImGui::GetMouseDragDelta(0, 0.0f).x), {}};
}

void paint(const NumberLook& look, const std::string& text, ImVec2 low, ImVec2 high) {
    ImDrawList* list = ImGui::GetWindowDrawList();
    const ImGuiCol colour = ImGui::IsItemActive()    ? ImGuiCol_FrameBgActive
                            : ImGui::IsItemHovered() ? ImGuiCol_FrameBgHovered
                                                     : ImGuiCol_FrameBg;
    const float rounding = ImGui::GetStyle().FrameRounding;
    list->AddRectFilled(low, high, ImGui::GetColorU32(colour), rounding);
    const double range = look.maximum - look.minimum;
    if (range > 0.0 && range <= 10.0 && !look.mixed) {
        const float share = float(std::clamp((look.value - look.minimum) / range, 0.0, 1.0));
        list->AddRectFilled(low, ImVec2(low.x + share * (high.x - low.x), high.y), IM_COL32(120, 82, 36, 150),
                            rounding);
    }
    const float padding = 0.35f * unit(), middle = 0.5f * (low.y + high.y - unit());
    list->PushClipRect(low, high, true);
    list->AddText(ImVec2(low.x + padding, middle),
                  ImGui::GetColorU32(look.mixed ? ImGuiCol_TextDisabled : ImGuiCol_Text), text.c_str());
    const float wide = ImGui::CalcTextSize(look.unit.c_str()).x;
    if (ImGui::CalcTextSize(text.c_str()).x + wide + 3.0f * padding < high.x - low.x)
        list->AddText(ImVec2(high.x - wide - padding, middle), ImGui::GetColorU32(ImGuiCol_TextDisabled),
                      look.unit.c_str());
    list->PopClipRect();
}

} // namespace

std::string number_text(double value, bool whole) {
    char text[64];
    if (whole)
        std::snprintf(text, sizeof text, "%.0f", value);
    else
        std::snprintf(text, sizeof text, "%.5g", value == 0.0 ? 0.0 : value);
    return text;
}

void begin_number_boxes() {
    BoxState& box = state();
    if (!box.seen)
        box.typing = box.dragging = 0;
    box.seen = box.to_next = false;
}

TextEdit& text_edit() {
    static TextEdit only;
    return only;
}

void leave_boxes() {
    state() = {};
    text_edit() = {};
    ImGui::ClearActiveID();
}

bool editing_number() {
    return state().typing != 0 || state().dragging != 0;
}

NumberEdit number_box(const std::string& name, const NumberLook& look) {
    BoxState& box = state();
    const ImGuiID id = ImGui::GetID(name.c_str());
    if (box.to_next && box.typing == 0 && look.enabled) {
        box.to_next = false;
        begin_typing(id, look);
    }
    box.seen = box.seen || box.typing == id || box.dragging == id;
    if (box.typing == id)
        return typed_box(name, look);
    const ImVec2 low = ImGui::GetCursorScreenPos();
    const ImVec2 high(low.x + look.width, low.y + ImGui::GetFrameHeight());
    ImGui::BeginDisabled(!look.enabled);
    ImGui::InvisibleButton(name.c_str(), ImVec2(std::max(look.width, 1.0f), ImGui::GetFrameHeight()));
    const std::string text = look.mixed ? look.instead : number_text(look.value, look.whole);
    paint(look, text, low, high);
    ImGui::EndDisabled();
    note(name, text);
    if (ImGui::IsItemHovered() && look.enabled)
        ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
    if (ImGui::IsItemActive())
        return drag(id, look);
    if (!ImGui::IsItemDeactivated() && box.dragging != id)
        return {};
    if (box.dragging == id) {
        box.dragging = 0;
        return {Phase::ended, 0.0, {}};
    }
    if (ImGui::IsItemHovered())
        begin_typing(id, look);
    return {};
}

} // namespace sunfleck::editor::ui

#include "editor/window/widgets.h"

#include <algorithm>
#include <cstdio>
#include <imgui_stdlib.h>

namespace sunfleck::editor::ui {
namespace {

struct Notebook {
    bool wanted = false;
    std::string prefix;
    std::vector<Note> notes;
};

Notebook& notebook() {
    static Notebook only;
    return only;
}

bool overlaps(ImVec2 low, ImVec2 high, ImVec2 clip_low, ImVec2 clip_high) {
    return low.x < clip_high.x && low.y < clip_high.y && high.x > clip_low.x && high.y > clip_low.y;
}

// What one sees of a name: what comes before "##".
std::string_view visible(std::string_view name) {
    return name.substr(0, name.find("##"));
}

constexpr float widest_tooltip = 24.0f; // in units

// Below the item, or above it near the window's lower edge: beside the pointer it would cover the items to the right,
// as those of a row of buttons. What is high, such as a picture, has it beside the pointer all the same.
void place_tooltip() {
    const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax(), display = ImGui::GetIO().DisplaySize;
    if (high.y - low.y > 4.0f * unit())
        return;
    const bool above = high.y > 0.75f * display.y;
    const float x = std::max(std::min(low.x, display.x - (widest_tooltip + 2.0f) * unit()), 0.0f), gap = 0.3f * unit();
    ImGui::SetNextWindowPos(ImVec2(x, above ? low.y - gap : high.y + gap), ImGuiCond_Always,
                            ImVec2(0.0f, above ? 1.0f : 0.0f));
}

} // namespace

void begin_notes(bool wanted) {
    notebook().wanted = wanted;
    notebook().notes.clear();
    notebook().prefix.clear();
}

const std::vector<Note>& notes() {
    return notebook().notes;
}

void note_place(std::string_view name, std::string_view value, ImVec2 low, ImVec2 high) {
    if (!notebook().wanted)
        return;
    const ImDrawList* list = ImGui::GetWindowDrawList();
    const ImVec2 clip_low = list->GetClipRectMin(), clip_high = list->GetClipRectMax();
    if (!overlaps(low, high, clip_low, clip_high))
        return;
    low = ImVec2(std::max(low.x, clip_low.x), std::max(low.y, clip_low.y));
    high = ImVec2(std::min(high.x, clip_high.x), std::min(high.y, clip_high.y));
    notebook().notes.push_back({notebook().prefix + std::string(name), std::string(value), low, high});
}

void note(std::string_view name, std::string_view value) {
    if (notebook().wanted)
        note_place(name, value, ImGui::GetItemRectMin(), ImGui::GetItemRectMax());
}

Scope::Scope(std::string_view name) : length_(notebook().prefix.size()) {
    ImGui::PushID(name.data(), name.data() + name.size());
    notebook().prefix.append(name).push_back('/');
}

Scope::~Scope() {
    ImGui::PopID();
    notebook().prefix.resize(length_);
}

void tooltip(std::string_view text) {
    if (text.empty() || !ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled))
        return;
    place_tooltip();
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(0.55f * unit(), 0.4f * unit())); // over the picture, too
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(widest_tooltip * unit());
    ImGui::TextUnformatted(text.data(), text.data() + text.size());
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
    ImGui::PopStyleVar();
}

bool button(const std::string& name, std::string_view tip, bool enabled, float width) {
    ImGui::BeginDisabled(!enabled);
    const bool pressed = ImGui::Button(name.c_str(), ImVec2(width, 0.0f));
    ImGui::EndDisabled();
    note(visible(name), enabled ? "" : "disabled");
    tooltip(tip);
    return pressed;
}

bool toggle(const std::string& name, bool& on, std::string_view tip) {
    const bool changed = ImGui::Checkbox(name.c_str(), &on);
    note(visible(name), on ? "on" : "off");
    tooltip(tip);
    return changed;
}

bool menu_item(const std::string& name, const std::string& shortcut, bool enabled, bool checked) {
    const bool chosen = ImGui::MenuItem(name.c_str(), shortcut.c_str(), checked, enabled);
    note(visible(name), !enabled ? "disabled" : checked ? "on" : "");
    return chosen;
}

void close_by_escape() {
    if (!editing_number() && ImGui::IsKeyPressed(ImGui::GetIO().KeyMap[ImGuiKey_Escape], false))
        ImGui::CloseCurrentPopup();
}

bool choice(const std::string& name, bool chosen, std::string_view tip) {
    const bool pressed = ImGui::Selectable(name.c_str(), chosen);
    note(visible(name), chosen ? "chosen" : "");
    tooltip(tip);
    return pressed;
}

bool text_box(const std::string& name, std::string& text, const char* hint, float width, bool enter) {
    ImGui::SetNextItemWidth(width);
    const float room = ImGui::CalcItemWidth() - 2.0f * ImGui::GetStyle().FramePadding.x;
    const bool changed = ImGui::InputTextWithHint(("##" + name).c_str(), fitted(hint, room).c_str(), &text,
                                                  enter ? ImGuiInputTextFlags_EnterReturnsTrue : 0);
    note(name, text);
    return changed;
}

std::string fitted(const std::string& text, float room) {
    if (text.size() <= 4 || ImGui::CalcTextSize(text.c_str()).x <= room)
        return text;
    const float before_dots = std::max(room - ImGui::CalcTextSize("...").x, 0.0f);
    const char *const begin = text.c_str(), *rest = begin;
    ImGui::GetFont()->CalcTextSizeA(unit(), before_dots, 0.0f, begin, begin + text.size(), &rest);
    return text.substr(0, std::size_t(rest - begin)) + "...";
}

void label(const std::string& text, std::string_view tip, bool dim) {
    const std::string shown = fitted(text, ImGui::GetContentRegionAvail().x);
    if (dim)
        ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted(shown.c_str());
    if (dim)
        ImGui::PopStyleColor();
    tooltip(shown == text ? std::string(tip) : text + (tip.empty() ? "" : "\n") + std::string(tip));
}

namespace {
int quiet_frames = 0;
}

void ask_for_quiet_frames() {
    quiet_frames = 3;
}

bool take_quiet_frame() {
    if (quiet_frames == 0)
        return false;
    --quiet_frames;
    return true;
}

void heading(const std::string& text) {
    ImGui::Dummy(ImVec2(0.0f, 0.2f * unit()));
    ImGui::TextColored(ImVec4(0.95f, 0.72f, 0.38f, 1.0f), "%s", text.c_str());
    ImGui::Separator();
}

void hint(const char* text) {
    ImGui::PushTextWrapPos(0.0f);
    ImGui::TextDisabled("%s", text);
    ImGui::PopTextWrapPos();
}

void text(const std::string& name, const std::string& value) {
    ImGui::TextUnformatted(value.c_str());
    note(name, value);
}

} // namespace sunfleck::editor::ui

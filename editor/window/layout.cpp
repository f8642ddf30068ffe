#include "editor/window/layout.h"

#include "editor/window/commands.h"

#include <algorithm>
#include <tuple>

namespace sunfleck::editor {
namespace {

constexpr float thickness = 5.0f; // of borders that can be dragged, pixels at scale 1
constexpr ImGuiWindowFlags root_flags = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                                        ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBringToFrontOnFocus |
                                        ImGuiWindowFlags_NoBackground | ImGuiWindowFlags_MenuBar;

const char* name_of(Dock dock) {
    switch (dock) {
    case Dock::left:
        return "left";
    case Dock::right:
        return "right";
    case Dock::bottom:
        break;
    }
    return "bottom";
}

} // namespace

Layout::Layout() {
    for (const PanelEntry& entry : panel_list())
        panels_.push_back({&entry, entry.make()});
}

void Layout::restore(const State& state) {
    state_ = state;
    for (float* share : {&state_.left, &state_.right, &state_.bottom})
        *share = std::clamp(*share, 0.05f, 0.6f);
    restore_front_ = true;
}

void Layout::take_keys(Session& session) const {
    const bool asked_for = std::exchange(session.keys_are_asked_for, false);
    const bool typing = asked_for || ImGui::GetIO().WantTextInput || ui::editing_number() || flying() ||
                        session.dialog != Dialog::none || ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopupId);
    if (!typing)
        session.commands->take_keys(*session.input, session);
}

// `share` of `whole` (pixels) grows towards where the dock is.
void Layout::border(const char* name, ImVec2 size, float& share, float whole) {
    const bool upright = size.y > size.x;
    ImGui::InvisibleButton(name, ImVec2(std::max(size.x, 1.0f), std::max(size.y, 1.0f)));
    ui::note(name);
    if (ImGui::IsItemHovered() || ImGui::IsItemActive()) {
        ImGui::SetMouseCursor(upright ? ImGuiMouseCursor_ResizeEW : ImGuiMouseCursor_ResizeNS);
        ImGui::GetWindowDrawList()->AddRectFilled(ImGui::GetItemRectMin(), ImGui::GetItemRectMax(),
                                                  IM_COL32(240, 160, 60, 120));
    }
    if (!ImGui::IsItemActive())
        return;
    const ImVec2 motion = ImGui::GetIO().MouseDelta;
    const float moved = (upright ? motion.x : motion.y) / std::max(whole, 1.0f);
    share = std::clamp(share + (&share == &state_.left ? moved : -moved), 0.05f, 0.6f);
}

void Layout::dock(Session& session, Dock dock, ImVec2 size) {
    ImGui::BeginChild(name_of(dock), size, false);
    ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, spacing_);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, padding_);
    if (ImGui::BeginTabBar("tabs", ImGuiTabBarFlags_FittingPolicyScroll)) {
        for (const Shown& shown : panels_) {
            if (shown.entry->dock != dock)
                continue;
            std::string& front = state_.front[std::size_t(dock)];
            const bool asked = session.front == shown.entry->name;
            const bool bring = asked || (restore_front_ && front == shown.entry->name);
            if (asked)
                session.front.clear();
            const bool open =
                ImGui::BeginTabItem(shown.entry->name, nullptr, bring ? ImGuiTabItemFlags_SetSelected : 0);
            ui::note(std::string("tab ") + shown.entry->name, open ? "open" : "");
            ui::tooltip(shown.entry->tooltip);
            if (!open)
                continue;
            if (!restore_front_ || bring)
                front = shown.entry->name;
            ImGui::BeginChild("panel", ImVec2(0.0f, 0.0f), false, ImGuiWindowFlags_AlwaysUseWindowPadding);
            shown.panel->draw(session);
            ImGui::EndChild();
            ImGui::EndTabItem();
        }
        ImGui::EndTabBar();
    }
    ImGui::PopStyleVar(2);
    ImGui::EndChild();
}

// Viewport above, dock below.
void Layout::middle(Session& session, const ScenePicture* picture, ImVec2 size, float bottom, float wide) {
    if (ImGui::BeginChild("middle", size, false, ImGuiWindowFlags_NoBackground | ImGuiWindowFlags_NoScrollbar)) {
        if (ImGui::BeginChild("viewport", ImVec2(size.x, std::max(size.y - bottom - wide, 1.0f)), false,
                              ImGuiWindowFlags_NoBackground | ImGuiWindowFlags_NoScrollbar |
                                  ImGuiWindowFlags_NoScrollWithMouse))
            viewport_.draw(session, picture);
        ImGui::EndChild();
        border("border bottom", ImVec2(size.x, wide), state_.bottom, size.y);
        dock(session, Dock::bottom, ImVec2(size.x, bottom));
    }
    ImGui::EndChild();
}

// Side by side, from the cursor on.
void Layout::docks(Session& session, const ScenePicture* picture, ImVec2 room) {
    const float wide = std::floor(thickness * ui::unit() / 14.0f);
    const float left = std::floor(state_.left * room.x), right = std::floor(state_.right * room.x);
    const float between = std::max(room.x - left - right - 2.0f * wide, 1.0f);
    const ImVec2 begin = ImGui::GetCursorPos();
    const auto at = [&](float x) { ImGui::SetCursorPos(ImVec2(begin.x + x, begin.y)); };
    dock(session, Dock::left, ImVec2(left, room.y));
    at(left);
    border("border left", ImVec2(wide, room.y), state_.left, room.x);
    at(left + wide);
    middle(session, picture, ImVec2(between, room.y), std::floor(state_.bottom * room.y), wide);
    at(left + wide + between);
    border("border right", ImVec2(wide, room.y), state_.right, room.x);
    at(left + 2.0f * wide + between);
    dock(session, Dock::right, ImVec2(right, room.y));
    ImGui::SetCursorPos(ImVec2(begin.x, begin.y + room.y));
}

void Layout::draw(Session& session, const ScenePicture* picture) {
    if (std::exchange(document_, session.document->number()) != session.document->number())
        ui::leave_boxes(); // what is being typed or dragged is of another document
    if (std::exchange(session.usual_layout, false)) {
        const State usual;
        std::tie(state_.left, state_.right, state_.bottom) = std::tie(usual.left, usual.right, usual.bottom);
    }
    const ImVec2 all = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos(ImVec2(0.0f, 0.0f));
    ImGui::SetNextWindowSize(all);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(0.0f, 0.0f));
    ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0.0f);
    ImGui::Begin("root", nullptr, root_flags);
    ImGui::PopStyleVar(2);
    draw_menu_bar(session);
    spacing_ = ImGui::GetStyle().ItemSpacing;
    padding_ = ImGui::GetStyle().WindowPadding;
    ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, ImVec2(0.0f, 0.0f));
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(0.0f, 0.0f));
    const float status_height = ImGui::GetFrameHeight() + 2.0f;
    docks(session, picture, ImVec2(all.x, std::max(ImGui::GetContentRegionAvail().y - status_height, 1.0f)));
    if (ImGui::BeginChild("status", ImVec2(all.x, status_height), false, ImGuiWindowFlags_NoScrollbar)) {
        ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, spacing_);
        draw_status_bar(session, picture);
        ImGui::PopStyleVar();
    }
    ImGui::EndChild();
    ImGui::PopStyleVar(2);
    restore_front_ = false;
    draw_dialogs(session);
    ImGui::End();
    if (!ImGui::IsMouseDown(0) && !ImGui::IsAnyItemActive())
        session.document->cancel(); // of what was dragged nothing is there any more that could end it
}

} // namespace sunfleck::editor

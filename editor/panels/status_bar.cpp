// One line: the newest message, what the lighting is doing, and what a frame takes.
#include "editor/panels/panel.h"
#include "editor/window/opening.h"
#include "editor/window/saving.h"

#include <cstdio>

namespace sunfleck::editor {
namespace {

void progress(const char* name, const std::string& text, float share) {
    ImGui::ProgressBar(share, ImVec2(14.0f * ui::unit(), 0.0f), text.c_str());
    ui::note(name, text);
    ImGui::SameLine();
}

void stop_opening(Session& session) {
    session.messages.say("'" + session.opening->path().filename().string() + "' was not opened" +
                         (session.recovering ? "; its unsaved edits are offered by the next run" : ""));
    session.opening.reset();
    session.recovering.reset();
}

// Which file, and a way to leave it.
void loading(Session& session) {
    const std::string name = "Loading " + session.opening->path().filename().string();
    const float room = 14.0f * ui::unit();
    progress("loading", ui::fitted(name, room - ui::unit()), session.opening->share());
    ui::tooltip(session.opening->path().string());
    if (ui::button("Cancel##loading", "Leaves the file; the scene stays as it is"))
        stop_opening(session);
    ImGui::SameLine();
}

void saving(const Saving& now) {
    ui::text("saving", "Saving " + now.path().filename().string() + " ...");
    ImGui::SameLine();
}

void newest_message(Session& session) {
    if (session.messages.all().empty())
        return ui::label("Right button and W A S D: fly. Click: select. F: look at the selection.", {}, true);
    const Message& message = session.messages.all().back();
    const ImVec4 red(1.0f, 0.5f, 0.42f, 1.0f);
    if (message.kind == Message::Kind::error)
        ImGui::PushStyleColor(ImGuiCol_Text, red);
    std::string line = message.text;
    for (char& letter : line)
        letter = letter == '\n' ? ' ' : letter;
    ui::label(line);
    if (message.kind == Message::Kind::error)
        ImGui::PopStyleColor();
    ui::note("message", message.text);
}

std::string frame_text(const ScenePicture& picture) {
    char text[120];
    std::snprintf(text, sizeof text, "EV %.1f   %u x %u   %.1f ms", double(picture.ev100),
                  picture.image.description().width, picture.image.description().height, picture.frame_ms);
    return text;
}

// What takes more than it should; empty: nothing.
std::string over_budget(const Session& session, const ScenePicture* picture) {
    std::string text;
    if (picture == nullptr)
        return text;
    if (picture->frame_ms > double(session.budgets.frame_ms))
        text = "frame time";
    for (const auto& [name, most] : session.budgets.counters)
        if (picture->statistics.counters[name] > most)
            text += (text.empty() ? "" : ", ") + name;
    return text;
}

} // namespace

void draw_status_bar(Session& session, const ScenePicture* picture) {
    const ui::Scope scope("status");
    const SceneStatus status = session.scene.status();
    ImGui::SetCursorPosX(0.5f * ui::unit());
    if (session.opening != nullptr)
        loading(session);
    else if (status.building)
        progress("building", "Lighting", status.share);
    else if (session.saving != nullptr)
        saving(*session.saving);
    const bool settled = picture != nullptr && picture->settled && !status.busy && session.opening == nullptr;
    const std::string frame = picture != nullptr ? frame_text(*picture) : "no picture yet";
    const float wide = ImGui::CalcTextSize(frame.c_str()).x + ui::unit();
    const float right = ImGui::GetWindowWidth() - wide;
    if (ImGui::BeginChild("message", ImVec2(right - ImGui::GetCursorPosX() - ui::unit(), 0.0f), false,
                          ImGuiWindowFlags_NoScrollbar))
        newest_message(session);
    ImGui::EndChild();
    ImGui::SameLine();
    ImGui::SetCursorPosX(right);
    ImGui::AlignTextToFramePadding();
    const bool slow = picture != nullptr && picture->frame_ms > double(session.budgets.frame_ms);
    ImGui::PushStyleColor(ImGuiCol_Text,
                          slow ? ImVec4(1.0f, 0.66f, 0.4f, 1.0f) : ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
    ImGui::TextUnformatted(frame.c_str());
    ImGui::PopStyleColor();
    ui::note("frame", frame);
    const std::string over = over_budget(session, picture);
    ui::note("budget", over.empty() ? "kept" : over);
    ui::tooltip(over.empty() ? "All budgets are kept" : "Over the budget: " + over);
    ui::note_place("settled", settled ? "yes" : "no", ImGui::GetItemRectMin(), ImGui::GetItemRectMax());
}

} // namespace sunfleck::editor

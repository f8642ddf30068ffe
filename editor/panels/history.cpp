// What was done.
#include "editor/panels/panel.h"

namespace sunfleck::editor {
namespace {

class HistoryPanel final : public Panel {
public:
    void draw(Session& session) override;

private:
    std::size_t shown_ = 0;
};

void HistoryPanel::draw(Session& session) {
    const ui::Scope scope("history");
    Document& document = *session.document;
    const History& history = document.history();
    const std::size_t position = history.position();
    std::size_t wanted = position;
    ImGuiListClipper clipper;
    clipper.Begin(int(history.entries().size()) + 1, ImGui::GetTextLineHeightWithSpacing());
    while (clipper.Step())
        for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i) {
            const bool undone = std::size_t(i) > position;
            ImGui::PushStyleColor(ImGuiCol_Text,
                                  ImGui::GetStyleColorVec4(undone ? ImGuiCol_TextDisabled : ImGuiCol_Text));
            const std::string name = i == 0 ? "As opened" : history.entries()[std::size_t(i) - 1].name;
            if (ui::choice(name + "##" + std::to_string(i), std::size_t(i) == position))
                wanted = std::size_t(i);
            ImGui::PopStyleColor();
        }
    if (shown_ != position) {
        shown_ = position;
        ImGui::SetScrollY(float(position) * ImGui::GetTextLineHeightWithSpacing() - 0.5f * ImGui::GetWindowHeight());
    }
    while (wanted < document.history().position() && document.undo()) {
    }
    while (wanted > document.history().position() && document.redo()) {
    }
}

} // namespace

std::unique_ptr<Panel> make_history() {
    return std::make_unique<HistoryPanel>();
}

} // namespace sunfleck::editor

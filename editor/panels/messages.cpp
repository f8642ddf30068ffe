// What the user was told, newest last.
#include "editor/panels/panel.h"

namespace sunfleck::editor {
namespace {

class MessagePanel final : public Panel {
public:
    void draw(Session& session) override;

private:
    std::uint64_t seen_ = 0;
};

ImVec4 message_colour(Message::Kind kind) {
    switch (kind) {
    case Message::Kind::error:
        return ImVec4(1.0f, 0.45f, 0.38f, 1.0f);
    case Message::Kind::warning:
        return ImVec4(0.98f, 0.78f, 0.36f, 1.0f);
    case Message::Kind::note:
        break;
    }
    return ImGui::GetStyleColorVec4(ImGuiCol_Text);
}

void MessagePanel::draw(Session& session) {
    const ui::Scope scope("messages");
    for (const Message& message : session.messages.all()) {
        ImGui::PushStyleColor(ImGuiCol_Text, message_colour(message.kind));
        ImGui::TextWrapped("%s", message.text.c_str());
        ImGui::PopStyleColor();
        ui::note("message " + std::to_string(message.number), message.text);
    }
    if (seen_ != session.messages.count()) {
        seen_ = session.messages.count();
        ImGui::SetScrollHereY(1.0f);
    }
}

} // namespace

std::unique_ptr<Panel> make_messages() {
    return std::make_unique<MessagePanel>();
}

} // namespace sunfleck::editor

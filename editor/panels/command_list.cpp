// All commands: searched, run, and given other keys.
#include "editor/panels/panel.h"
#include "editor/window/commands.h"

#include <algorithm>
#include <cctype>

namespace sunfleck::editor {
namespace {

class CommandPanel final : public Panel {
public:
    void draw(Session& session) override;

private:
    void row(Session& session, Command& command);
    static void bind(Session& session, Command& command, const Shortcut& keys);
    void take_key(Session& session, Command& command);
    std::string filter_, waiting_; // path of the command whose keys are asked for
    int waited_ = 0;               // the last frame in which its row was there
};

bool contains(std::string text, std::string wanted) {
    for (std::string* one : {&text, &wanted})
        std::transform(one->begin(), one->end(), one->begin(),
                       [](unsigned char letter) { return char(std::tolower(letter)); });
    return text.find(wanted) != std::string::npos;
}

// Whoever presses a button elsewhere has thought better of it.
void CommandPanel::take_key(Session& session, Command& command) {
    const app::InputState& input = *session.input;
    for (const app::Key key : input.went_down) {
        const bool modifier = key >= app::key_left_shift && key <= app::key_right_alt + 1;
        if (modifier || (key >= app::first_mouse_button && ImGui::IsItemHovered()))
            continue;
        waiting_.clear();
        if (key >= app::first_mouse_button)
            return;
        if (key != app::key_escape)
            bind(session, command,
                 {key, input.down(app::key_left_control) || input.down(app::key_right_control),
                  input.down(app::key_left_shift) || input.down(app::key_right_shift),
                  input.down(app::key_left_alt) || input.down(app::key_right_alt)});
        return;
    }
}

void CommandPanel::bind(Session& session, Command& command, const Shortcut& keys) {
    const Command* const had = session.commands->bind(command, keys);
    if (had != nullptr)
        session.messages.say(shortcut_text(keys) + " is now '" + command.group + ": " + command.name + "'; '" +
                                 had->group + ": " + had->name + "', which had it, has no keys",
                             Message::Kind::warning);
}

void CommandPanel::row(Session& session, Command& command) {
    const ui::Scope scope(command.path());
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    if (ui::button(command.group + ": " + command.name + "##run", command.tooltip, command.is_enabled(session)))
        session.commands->run(command, session);
    ImGui::TableNextColumn();
    const bool waits = waiting_ == command.path();
    const std::string keys = shortcut_text(command.shortcut);
    const std::string shown = waits ? "press keys" : keys.empty() ? "none" : keys;
    if (ui::button(shown + "##keys", "Click, then press other keys; Escape leaves them as they are", true,
                   9.0f * ui::unit()))
        waiting_ = waits ? "" : command.path();
    else if (waits)
        take_key(session, command);
    if (waiting_ == command.path()) {
        waited_ = ImGui::GetFrameCount();
        session.keys_are_asked_for = true;
    }
    ImGui::TableNextColumn();
    if (!(command.shortcut == command.usual)) {
        const std::string usual = shortcut_text(command.usual);
        if (ui::button("Usual##usual", "Gives it its usual keys again: " + (usual.empty() ? "none" : usual)))
            bind(session, command, command.usual);
        ImGui::SameLine();
    }
    ui::label(command.tooltip, {}, true);
}

void CommandPanel::draw(Session& session) {
    const ui::Scope scope("commands");
    if (waited_ + 1 < ImGui::GetFrameCount()) // it was out of sight
        waiting_.clear();
    ui::text_box("search", filter_, "Search commands", 13.0f * ui::unit());
    ImGui::SameLine();
    if (ui::button("Usual keys", "Gives every command its usual keys again", !session.commands->changed_keys().empty()))
        session.commands->use_usual_keys();
    ImGui::SameLine();
    ui::label("Flying: hold the right button; W A S D, Q and E, shift, wheel", {}, true);
    ImGui::BeginChild("rows");
    if (ImGui::BeginTable("rows", 3, ImGuiTableFlags_SizingFixedFit)) {
        ImGui::TableSetupColumn("command");
        ImGui::TableSetupColumn("keys");
        ImGui::TableSetupColumn("tooltip", ImGuiTableColumnFlags_WidthStretch);
        for (Command& command : session.commands->all())
            if (filter_.empty() || contains(command.path() + command.tooltip, filter_))
                row(session, command);
        ImGui::EndTable();
    }
    ImGui::EndChild();
}

} // namespace

std::unique_ptr<Panel> make_command_list() {
    return std::make_unique<CommandPanel>();
}

} // namespace sunfleck::editor

#include "editor/window/commands.h"

#include "editor/window/widgets.h"

#include <algorithm>

namespace sunfleck::editor {

std::string shortcut_text(const Shortcut& shortcut) {
    if (shortcut.key == app::no_key)
        return {};
    std::string key = app::key_name(shortcut.key);
    key[0] = char(std::toupper(static_cast<unsigned char>(key[0])));
    return std::string(shortcut.control ? "Ctrl+" : "") + (shortcut.shift ? "Shift+" : "") +
           (shortcut.alt ? "Alt+" : "") + key;
}

Shortcut shortcut_from_text(const std::string& text) {
    Shortcut result;
    std::string rest = text;
    const auto take = [&](std::string_view prefix) {
        if (!rest.starts_with(prefix) || rest.size() == prefix.size())
            return false;
        rest.erase(0, prefix.size());
        return true;
    };
    result.control = take("Ctrl+");
    result.shift = take("Shift+");
    result.alt = take("Alt+");
    for (app::Key key = 0; key < app::key_count; ++key)
        if (shortcut_text({key}) == rest)
            result.key = key;
    return result;
}

Commands::Commands() {
    add_file_commands(all_);
    add_edit_commands(all_);
    add_template_commands(all_);
    add_show_commands(all_);
    add_overlay_commands(all_);
    add_gizmo_commands(all_);
    add_camera_commands(all_);
    add_view_commands(all_);
    for (Command& command : all_)
        command.usual = command.shortcut;
}

Command* Commands::find(std::string_view path) {
    const auto found = std::find_if(all_.begin(), all_.end(), [&](const Command& one) { return one.path() == path; });
    return found == all_.end() ? nullptr : &*found;
}

void Commands::run(Command& command, Session& session) {
    if (!command.is_enabled(session))
        return;
    ++command.uses;
    if (session.document->in_gesture()) { // a hand still drags: what it has done so far was not meant to stay
        session.document->cancel();
        session.messages.say("What was being dragged is where it was");
    }
    command.run(session);
}

void Commands::take_keys(const app::InputState& input, Session& session) {
    const auto down = [&](app::Key left, app::Key right) { return input.down(left) || input.down(right); };
    const bool control = down(app::key_left_control, app::key_right_control);
    const bool shift = down(app::key_left_shift, app::key_right_shift),
               alt = down(app::key_left_alt, app::key_right_alt);
    for (const app::Key key : input.went_down) {
        if (key == app::key_escape && session.document->in_gesture())
            continue; // it is meant for what is being dragged
        const Shortcut pressed{key, control, shift, alt};
        for (Command& command : all_)
            if (command.shortcut == pressed)
                return run(command, session);
    }
}

Command* Commands::bind(Command& command, const Shortcut& shortcut) {
    Command* had = nullptr;
    for (Command& other : all_)
        if (shortcut.key != app::no_key && &other != &command && other.shortcut == shortcut)
            had = &other;
    if (had != nullptr)
        had->shortcut = {};
    command.shortcut = shortcut;
    return had;
}

void Commands::use_usual_keys() {
    for (Command& command : all_)
        command.shortcut = command.usual;
}

std::map<std::string, std::string> Commands::changed_keys() const {
    std::map<std::string, std::string> result;
    for (const Command& command : all_)
        if (!(command.shortcut == command.usual))
            result[command.path()] = shortcut_text(command.shortcut);
    return result;
}

void Commands::change_keys(const std::map<std::string, std::string>& keys) {
    for (const auto& [path, text] : keys)
        if (Command* command = find(path))
            bind(*command, shortcut_from_text(text));
}

std::vector<std::string> Commands::groups() const {
    std::vector<std::string> result;
    for (const Command& command : all_)
        if (std::find(result.begin(), result.end(), command.group) == result.end())
            result.push_back(command.group);
    return result;
}

void Commands::menu(const std::string& group, Session& session) {
    for (Command& command : all_) {
        if (command.group != group)
            continue;
        const std::string title = command.title ? command.title(session) : command.name;
        if (ui::menu_item(title + "##" + command.name, shortcut_text(command.shortcut), command.is_enabled(session),
                          command.is_checked(session)))
            run(command, session);
        ui::tooltip(command.tooltip);
    }
}

} // namespace sunfleck::editor

// Everything that can be done without typing a value: what menus offer, what keys do, what the command list finds.
#pragma once

#include "editor/window/session.h"

namespace sunfleck::editor {

struct Shortcut {
    app::Key key = app::no_key;
    bool control = false, shift = false, alt = false;
    bool operator==(const Shortcut&) const = default;
};
// "Ctrl+Shift+Z"; "" without a key.
std::string shortcut_text(const Shortcut& shortcut);
// The inverse; without a key if the text is not a shortcut.
Shortcut shortcut_from_text(const std::string& text);

struct Command {
    std::string group, name; // menu and entry, "/" between them in paths: "Edit", "Delete"
    std::string tooltip;
    Shortcut shortcut; // as it is used now
    std::function<void(Session&)> run;
    std::function<bool(Session&)> enabled{};      // none: always
    std::function<bool(Session&)> checked{};      // none: it is not a switch
    std::function<std::string(Session&)> title{}; // in menus, in place of the name; none: the name
    std::uint64_t uses = 0;
    Shortcut usual{}; // where nobody has changed it

    std::string path() const { return group + "/" + name; }
    bool is_enabled(Session& session) const { return !enabled || enabled(session); }
    bool is_checked(Session& session) const { return checked && checked(session); }
};

class Commands {
public:
    Commands();
    std::vector<Command>& all() { return all_; }
    Command* find(std::string_view path);
    // If it is enabled.
    void run(Command& command, Session& session);
    // Runs what the keys of this frame ask for.
    void take_keys(const app::InputState& input, Session& session);
    // Gives a command other keys; what had them has none, and is returned; null: nothing had them.
    Command* bind(Command& command, const Shortcut& shortcut);
    // Every command has its usual keys again.
    void use_usual_keys();
    // Keys that are not the usual ones, as texts by the paths of their commands; and the inverse.
    std::map<std::string, std::string> changed_keys() const;
    void change_keys(const std::map<std::string, std::string>& keys);
    // The group's entries, as a menu.
    void menu(const std::string& group, Session& session);
    std::vector<std::string> groups() const;

private:
    std::vector<Command> all_;
};

// Parts of the list.
void add_file_commands(std::vector<Command>& list);
void add_edit_commands(std::vector<Command>& list);
void add_show_commands(std::vector<Command>& list);
void add_gizmo_commands(std::vector<Command>& list);
void add_template_commands(std::vector<Command>& list);
void add_overlay_commands(std::vector<Command>& list);
void add_camera_commands(std::vector<Command>& list);
void add_view_commands(std::vector<Command>& list);

} // namespace sunfleck::editor

// The menus: commands by group, files that were opened before, and the scenes that come with the program.
#include "editor/panels/panel.h"
#include "editor/window/commands.h"
#include "viewer/built_in_scenes.h"

namespace sunfleck::editor {
namespace {

void recent_menu(Session& session) {
    if (!ImGui::BeginMenu("Open recent", !session.recent_files.empty()))
        return;
    const std::vector<std::string> files = session.recent_files; // opening changes the list
    for (const std::string& file : files)
        if (ui::menu_item(file, "", true))
            session.open(file);
    ImGui::EndMenu();
}

void built_in_menu(Session& session) {
    if (!ImGui::BeginMenu("Built-in scenes"))
        return;
    static const std::vector<std::string> names = viewer::built_in_scene_names();
    for (const std::string& name : names)
        if (ui::menu_item(name, "", true))
            if (const auto path = viewer::find_scene(name); session.messages.check(path ? Status() : path.error()))
                session.open(*path);
    ImGui::EndMenu();
}

// Names within the menu's window end before it does.
void entries(Session& session, const std::string& group) {
    const ui::Scope in_group(group);
    session.commands->menu(group, session);
    if (group == session.commands->groups().front()) {
        ImGui::Separator();
        recent_menu(session);
        built_in_menu(session);
    }
}

} // namespace

void draw_menu_bar(Session& session) {
    const ui::Scope scope("menu");
    if (!ImGui::BeginMenuBar())
        return;
    for (const std::string& group : session.commands->groups()) {
        const bool open = ImGui::BeginMenu(group.c_str());
        ui::note(group);
        if (!open)
            continue;
        entries(session, group);
        ui::close_by_escape();
        ImGui::EndMenu();
    }
    const std::string title = session.file_name() + (session.document->unsaved() ? " *" : "");
    const float wide = ImGui::CalcTextSize(title.c_str()).x;
    ImGui::SetCursorPosX(ImGui::GetWindowWidth() - wide - ui::unit());
    ImGui::TextDisabled("%s", title.c_str());
    ui::note("title", title);
    ImGui::EndMenuBar();
}

} // namespace sunfleck::editor

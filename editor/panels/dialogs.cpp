// Questions in front of everything else: which file, and what becomes of unsaved edits.
#include "editor/panels/panel.h"
#include "editor/window/commands.h"
#include "editor/window/opening.h"
#include "engine/core/file.h"

#include <algorithm>
#include <imgui_stdlib.h>

namespace sunfleck::editor {
namespace {

namespace fs = std::filesystem;

// Folder and name that are being chosen.
struct FileChoice {
    fs::path folder;
    std::string name;
    std::vector<fs::path> folders, files;
    std::string problem;
    fs::path replaces; // another scene's file: it has been said that the next press replaces it
};

FileChoice& choice() {
    static FileChoice only;
    return only;
}

bool is_scene(const fs::path& path) {
    const std::string name = path.filename().string();
    return name.ends_with(".scene.json") || name.ends_with(".gltf") || name.ends_with(".glb");
}

void list_folder(const fs::path& folder) {
    FileChoice& now = choice();
    std::error_code code;
    now.folder = folder.lexically_normal();
    now.folders.clear();
    now.files.clear();
    now.problem.clear();
    for (const fs::path& path : folder_content(folder, code)) {
        std::error_code gone;
        if (path.filename().string().front() == '.')
            continue;
        if (fs::is_directory(path, gone))
            now.folders.push_back(path);
        else if (is_scene(path))
            now.files.push_back(path);
    }
    if (code)
        now.problem = code.message();
    std::sort(now.folders.begin(), now.folders.end());
    std::sort(now.files.begin(), now.files.end());
}

std::string stem_of(const fs::path& path) {
    const std::string name = path.filename().string();
    return name.substr(0, name.find('.'));
}

// The scene's own name, or with the lowest number behind it that makes it free: of a scene file, and of the geometry
// beside it, which may be the glTF file that the scene came from.
std::string free_name(const Session& session) {
    const fs::path& path = session.document->path();
    const std::string stem = path.empty() ? "scene" : stem_of(path);
    const auto is_there = [](const fs::path& file) {
        std::error_code code;
        return fs::exists(fs::symlink_status(file, code));
    };
    std::string free = stem;
    for (int number = 2;; ++number) {
        const fs::path scene = choice().folder / (free + ".scene.json");
        const bool is_own = is_there(scene) && !session.document->is_another_file(scene);
        if (is_own || (!is_there(scene) && !is_there(choice().folder / (free + ".glb"))))
            return scene.filename().string();
        free = stem + " " + std::to_string(number);
    }
}

void begin_choice(Session& session) {
    choice().replaces.clear();
    std::error_code code;
    const fs::path& path = session.document->path();
    list_folder(path.empty() || is_built_in(path) ? fs::current_path(code) : fs::absolute(path, code).parent_path());
    choice().name.clear();
    if (session.dialog == Dialog::save_as)
        choice().name = free_name(session);
}

void folder_list() {
    FileChoice& now = choice();
    ImGui::BeginChild("files", ImVec2(36.0f * ui::unit(), 16.0f * ui::unit()), true);
    fs::path enter;
    if (ui::choice("..", false, "The folder above"))
        enter = now.folder.parent_path();
    for (const fs::path& folder : now.folders)
        if (ui::choice(folder.filename().string() + "/", false))
            enter = folder;
    for (const fs::path& file : now.files)
        if (ui::choice(file.filename().string(), file.filename() == now.name))
            now.name = file.filename().string();
    ImGui::EndChild();
    if (!enter.empty())
        list_folder(enter);
}

void choose(Session& session) {
    FileChoice& now = choice();
    const fs::path path = fs::path(now.name).is_absolute() ? fs::path(now.name) : now.folder / now.name;
    std::error_code code;
    if (fs::is_directory(path, code))
        return list_folder(path);
    if (session.dialog == Dialog::open) {
        if (!fs::exists(path, code)) {
            now.problem = "There is no such file";
            return;
        }
        session.dialog = Dialog::none;
        return session.open(path);
    }
    const bool is_another = session.document->is_another_file(path), is_asked = is_another && now.replaces != path;
    now.replaces = is_asked ? path : fs::path();
    if (is_asked) {
        now.problem = "'" + path.filename().string() +
                      "' exists; pressing Save once more replaces it, with its geometry, by this scene";
        return;
    }
    if (!session.save(path, is_another ? Replace::any : Replace::own)) {
        now.problem = session.messages.all().back().text;
        return;
    }
    session.dialog = Dialog::none;
    if (session.after_unsaved)
        std::exchange(session.after_unsaved, {})();
}

void file_dialog(Session& session) {
    FileChoice& now = choice();
    ImGui::TextDisabled("%s", now.folder.c_str());
    folder_list();
    if (ImGui::IsWindowAppearing())
        ImGui::SetKeyboardFocusHere();
    const bool enter = ui::text_box("name", now.name, "Name, or a whole path", 36.0f * ui::unit(), true);
    if (!now.problem.empty()) {
        ImGui::PushTextWrapPos(36.0f * ui::unit());
        ImGui::TextColored(ImVec4(1.0f, 0.5f, 0.42f, 1.0f), "%s", now.problem.c_str());
        ui::note("problem", now.problem);
        ImGui::PopTextWrapPos();
    }
    const bool saves = session.dialog == Dialog::save_as;
    if (ui::button(saves ? "Save" : "Open", {}, !now.name.empty(), 8.0f * ui::unit()) || enter)
        choose(session);
    ImGui::SameLine();
    if (ui::button("Cancel", {}, true, 8.0f * ui::unit())) {
        session.dialog = Dialog::none;
        session.after_unsaved = {};
    }
}

void unsaved_dialog(Session& session) {
    ImGui::Text("%s has edits that were not saved.", session.file_name().c_str());
    ImGui::Dummy(ImVec2(0.0f, 0.4f * ui::unit()));
    const std::filesystem::path& path = session.document->path();
    const bool in_place = path.string().ends_with(".scene.json") && !is_built_in(path);
    if (ui::button(in_place ? "Save" : "Save as...", {}, true, 8.0f * ui::unit())) {
        session.dialog = Dialog::none;
        if (!in_place)
            session.dialog = Dialog::save_as; // goes on from there
        else if (session.save(session.document->path()))
            std::exchange(session.after_unsaved, {})();
    }
    ImGui::SameLine();
    if (ui::button("Discard", "The edits are lost", true, 8.0f * ui::unit())) {
        session.dialog = Dialog::none;
        std::exchange(session.after_unsaved, {})();
    }
    ImGui::SameLine();
    if (ui::button("Cancel", {}, true, 8.0f * ui::unit())) {
        session.dialog = Dialog::none;
        session.after_unsaved = {};
    }
}

// What would be restored is said before it is.
void recover_dialog(Session& session) {
    const Recovered& recovered = session.recovered.back();
    const std::string file = recovered.file.empty() ? "a scene without a file" : recovered.file;
    ImGui::PushTextWrapPos(36.0f * ui::unit());
    ui::text("question", "The program ended while " + file + " had unsaved edits (" + std::to_string(recovered.count) +
                             "). The last ones:");
    ImGui::PopTextWrapPos();
    ImGui::BeginChild("edits", ImVec2(36.0f * ui::unit(), 9.0f * ui::unit()), true);
    for (std::size_t i = 0; i < recovered.edits.size(); ++i) {
        ImGui::BulletText("%s", recovered.edits[i].c_str());
        ui::note("edit " + std::to_string(i + 1), recovered.edits[i]);
    }
    ImGui::EndChild();
    if (!recovered.complete)
        ImGui::TextUnformatted("What was edited after these could not be kept.");
    ImGui::PushTextWrapPos(36.0f * ui::unit());
    if (recovered.user_file == UserFile::changed)
        ui::text("fit",
                 "The file was changed since, and the edits go on from what it was. Recover makes those that have "
                 "a place in it as it is now. To have all of them: Later, put the old file back, start again.");
    if (recovered.user_file == UserFile::gone)
        ui::text("fit",
                 "The file is gone, and the edits go on from it. To have them: Later, put it back, start again.");
    ImGui::PopTextWrapPos();
    ImGui::TextDisabled("They open as a scene of their own; no file is changed.");
    const bool recover = ui::button("Recover", {}, recovered.user_file != UserFile::gone, 8.0f * ui::unit());
    ImGui::SameLine();
    const bool discard = ui::button("Discard", "The edits are lost", true, 8.0f * ui::unit());
    ImGui::SameLine();
    const bool later = ui::button("Later", "They are offered again at the next start", true, 8.0f * ui::unit());
    if (recover)
        session.recover(recovered);
    if (discard)
        Recovery::discard(recovered);
    if (!recover && !discard && !later)
        return;
    session.recovered.pop_back();
    if (recover || session.recovered.empty())
        session.dialog = Dialog::none;
}

const char* title_of(Dialog dialog) {
    switch (dialog) {
    case Dialog::open:
        return "Open a scene";
    case Dialog::save_as:
        return "Save the scene";
    case Dialog::unsaved:
        return "Unsaved edits";
    case Dialog::recover:
        return "Unsaved edits of an earlier run";
    case Dialog::none:
        break;
    }
    return "";
}

} // namespace

void draw_dialogs(Session& session) {
    static Dialog shown = Dialog::none;
    const ui::Scope scope("dialog");
    if (session.dialog != shown) {
        shown = session.dialog;
        if (shown == Dialog::open || shown == Dialog::save_as)
            begin_choice(session);
        if (shown != Dialog::none)
            ImGui::OpenPopup(title_of(shown));
    }
    if (shown == Dialog::none)
        return;
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos(ImVec2(0.5f * size.x, 0.5f * size.y), ImGuiCond_Always, ImVec2(0.5f, 0.5f));
    if (!ImGui::BeginPopupModal(title_of(shown), nullptr, ImGuiWindowFlags_AlwaysAutoResize))
        return;
    if (shown == Dialog::unsaved)
        unsaved_dialog(session);
    else if (shown == Dialog::recover)
        recover_dialog(session);
    else
        file_dialog(session);
    const bool escape = ImGui::IsKeyPressed(ImGui::GetIO().KeyMap[ImGuiKey_Escape], false);
    if (escape && session.dialog == shown) {
        session.dialog = Dialog::none;
        session.after_unsaved = {};
    }
    if (session.dialog != shown) {
        shown = Dialog::none; // another one opens in the next frame
        ImGui::CloseCurrentPopup();
    }
    ImGui::EndPopup();
}

} // namespace sunfleck::editor

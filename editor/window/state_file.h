// What is kept from run to run: layout, files that were opened, where their cameras stood, and changed keys.
#pragma once

#include "editor/window/commands.h"
#include "editor/window/layout.h"

#include <map>

namespace sunfleck::editor {

struct EditorState {
    Layout::State layout;
    std::uint32_t width = 0, height = 0; // of the window; 0: not known
    std::vector<std::string> recent_files;
    std::map<std::string, std::string> keys;          // changed ones: a command's path, its shortcut
    std::map<std::string, scene::CameraView> cameras; // by file
    Budgets budgets;
};

// In user_settings_folder(); empty if there is none: nothing is kept from run to run then.
std::filesystem::path usual_state_file();
// `problem`: why it could not be read; the rest is as usual then. A damaged file is renamed, with ".damaged" appended;
// one that could not be read at all stays, and `may_save` says that it is not to be replaced.
EditorState load_state(const std::filesystem::path& path, std::string& problem, bool& may_save);
Status save_state(const std::filesystem::path& path, const EditorState& state);

} // namespace sunfleck::editor

// What is kept from run to run: layout, files that were opened, where their cameras stood, changed keys, budgets and
// steps.
#pragma once

#include "editor/window/commands.h"
#include "editor/window/layout.h"

#include <chrono>
#include <map>

namespace sunfleck::editor {

struct EditorState {
    Layout::State layout;
    std::uint32_t width = 0, height = 0; // of the window; 0: not known
    std::vector<std::string> recent_files;
    std::map<std::string, std::string> keys;          // changed ones: a command's path, its shortcut
    std::map<std::string, scene::CameraView> cameras; // by file
    Budgets budgets;
    SnapSteps steps;
};

// In user_settings_folder(); empty if there is none: nothing is kept from run to run then.
std::filesystem::path usual_state_file();
// `problem`: why it could not be read; the rest is as usual then. A damaged file is renamed, with ".damaged" appended;
// one that could not be read at all stays, and `may_save` says that it is not to be replaced.
EditorState load_state(const std::filesystem::path& path, std::string& problem, bool& may_save);
// As it is written: equal texts, equal states.
std::string state_text(const EditorState& state);
Status save_state(const std::filesystem::path& path, const EditorState& state);
// The same where the file may have changed since it was as `before` says, for another editor runs, too: what differs
// between `before` and `state` is written, all else stays as it is in the file. Files of both are in the recent ones.
Status save_changes(const std::filesystem::path& path, const std::string& before, const EditorState& state);

// Says when the state is to be kept while the program runs: when the GUI has rested for a second since it was drawn, or
// is drawn all the time. In between it costs nothing.
class StateKeeper {
public:
    using Clock = std::chrono::steady_clock;
    static constexpr std::chrono::seconds rest{1}, longest{10};
    StateKeeper() = default;
    // `loaded`: as the file has it.
    explicit StateKeeper(const EditorState& loaded) : text_(state_text(loaded)), written_(text_) {}
    void note_frame(Clock::time_point now = Clock::now()) {
        drawn_ = now;
        is_old_ = true;
    }
    bool is_due(Clock::time_point now = Clock::now()) const {
        return is_old_ && (now - drawn_ >= rest || now - kept_ >= longest);
    }
    // Writes it where it is another than last time. What could not be written is not tried again until it changes, and
    // the same error is returned once.
    Status keep(const std::filesystem::path& path, const EditorState& state, Clock::time_point now = Clock::now());
    // For the last time, and whatever was said before.
    Status finish(const std::filesystem::path& path, const EditorState& state) const {
        return save_changes(path, written_, state);
    }

private:
    bool is_old_ = false;
    Clock::time_point drawn_, kept_ = Clock::now();
    std::string text_, written_, problem_; // written_: as the file has been told
};

} // namespace sunfleck::editor

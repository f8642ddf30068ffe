// What scripts that drive the window read: where its widgets are, and what the program did.
#pragma once

#include "editor/window/session.h"
#include "editor/window/widgets.h"

namespace sunfleck::editor {

struct ReportFigures {
    std::uint64_t gui_frames = 0, wake_ups = 0;
    std::vector<double> gui_ms; // of the first thousands
    std::vector<double> gui_at; // when they ended, s on the system's clock
    std::chrono::steady_clock::time_point last{};
    double longest_gap_ms = 0.0; // between two GUI frames that followed each other within a second

    void note_frame(double milliseconds);
};

// JSON: {"pointer": [x, y], "widgets": [{"name", "value", "x", "y", "width", "height"}, ...]}, pixels of the window.
// Written only where it differs from what was written last. Events come in order: once the pointer is said to be where
// a script has moved it, all that the script sent before has been taken, too.
Status write_widgets(const std::filesystem::path& path, const std::vector<ui::Note>& notes, vec2 pointer);
Status write_report(const std::filesystem::path& path, const ReportFigures& figures, Session& session,
                    int validation_messages);

} // namespace sunfleck::editor

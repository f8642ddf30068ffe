// The editor's program: window, device, and the loop that draws the GUI when there is something new.
#pragma once

#include "engine/core/result.h"

#include <cstdint>
#include <string>

namespace sunfleck::editor {

struct Options {
    std::string scene; // empty: nothing is open
    std::uint32_t width = 1440, height = 900;
    float scale = 0.0f; // of text; 0: the screen's
    std::string device;
    bool validation = false;
    std::uint32_t memory_mib = 0; // that may be taken; 0: three quarters of what is free
    bool allow_outside = false;   // io::ImportOptions::allow_outside, of all scenes
    std::string shaders;    // the project's folder: its shaders are compiled again when they change; empty: they stay
    std::string state_file; // empty: sunfleck/editor.json in the configuration folder
    std::string widgets;    // file for the visible widgets and the pointer, written whenever the GUI has come to rest
    std::string report;     // file for counters, written at the end
    bool operator==(const Options&) const = default;
};

// Until the user quits, or a signal asks for the end.
Status run(const Options& options);

} // namespace sunfleck::editor

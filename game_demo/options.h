// Options of the command line.
#pragma once

#include "game_demo/level.h"

#include <optional>

namespace sunfleck::demo {

struct Options {
    bool headless = false, validation = false;
    bool hitches = false;              // says which frames took long, and why
    bool each_frame = false;           // a headless run's stats.json has the times of every frame, too
    std::uint32_t frames = 0;          // 0: until the window is closed, or the input ends
    std::uint32_t pictures = 8;        // written by a headless run, evenly spaced from the first frame to the last
    std::uint32_t steps_per_frame = 2; // of a headless run
    bool simulate = false;             // steps only: no pictures, no device
    gi::SensorSettings sensors;
    std::string output, device, scene = "lantern_house", input, record;
    std::optional<Preset> preset;
    std::optional<bool> transfer; // overrides the preset
    std::uint32_t width = 1280, height = 720;
    bool indirect = true;
    std::uint32_t memory_mib = 0;  // that may be taken; 0: three quarters of what is free
    std::string settings_file;     // empty: the default one
    std::string state;             // file for what the window's game does; see state_file.h
    std::string screenshots = "."; // folder
    bool allow_outside = false;
    std::optional<float> ev100; // a fixed exposure
    bool operator==(const Options&) const = default;
};

inline LevelSource source_of(const Options& options) {
    return {options.scene, options.allow_outside, options.sensors, options.ev100};
}

// Whether what a run in the window reads and writes can be read and written, before it takes anybody's time.
Status check_window_files(const Options& options);
Status run_window(const Options& options);
Status run_headless(const Options& options);
Status run_simulation(const Options& options); // --simulate

} // namespace sunfleck::demo

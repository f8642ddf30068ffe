// What the commands share: where built-in scenes are, options of scene and camera, the statistics' JSON, progress.
// CLI11 stays in program.cpp and the full JSON header in the files that use it: each costs seconds in every file.
#pragma once

#include "engine/core/exit_status.h"
#include "engine/statistics/summary.h"
#include "gi_module/settings.h"
#include "viewer/built_in_scenes.h"
#include "viewer/exposure.h"
#include "viewer/option_values.h"
#include "viewer/progress.h"
#include "viewer/scene_renderer.h"

#include <chrono>
#include <functional>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>

namespace sunfleck::command_line {

using Json = nlohmann::ordered_json;
using Size = viewer::PictureSize;

// Options that name a scene, a camera and a time, on `render` and `reference` alike.
struct SceneOptions {
    std::string scene;
    std::string camera;
    Size size{1280, 720};
    bool motion = true;
    float orbit_degrees = 0.0f; // per frame
    std::uint32_t frames = 1;
    std::uint32_t warmup = 3;
    std::map<std::string, std::string> lighting; // lighting settings that have options of their own, as given
    std::optional<float> ev100;                  // in place of the scene's
    io::ImportOptions import;
    std::string environment;      // picture file
    std::uint32_t memory_mib = 0; // 0: memory_limit's default
    std::string device;
    bool validation = false;
};
// --environment: the picture lights the scene in place of any environment that it has.
// `content_hash`: io::ImportOptions::content_hash.
Status apply_environment(const SceneOptions& options, ecs::Registry& registry, std::uint64_t* content_hash = nullptr);
// With a progress bar for what takes long, and Ctrl-C to stop.
io::ImportOptions import_options(const SceneOptions& options);

// What the command line or the scene says; none: the picture decides (viewer::automatic_exposure).
std::optional<float> exposure_of(const SceneOptions& options, ecs::Registry& registry);

using viewer::built_in_scene_names;
using viewer::find_scene;

// The camera of frame `frame` (counted from the first warm-up frame).
scene::CameraView camera_of_frame(const scene::CameraView& start, const SceneOptions& options, std::uint32_t frame);
// The step that movers show in that frame.
inline std::uint64_t step_of_frame(const SceneOptions& options, std::uint32_t frame) {
    return options.motion ? frame : 0;
}

// --set name=value over the lighting settings.
Status apply_setting(gi::Settings& settings, const std::string& assignment);
// What is wrong with it, for checks of options; empty: nothing.
std::string setting_problem(const std::string& assignment);
// Indented. What is no UTF-8, as names of files may be, is replaced: JSON cannot hold it.
std::string json_text(const Json& json);
Json settings_json(const gi::Settings& settings);

// Frames that were measured, in the shape that --stats and bench --json share.
struct Measurement {
    std::string scene;
    gi::Settings settings;
    Size size{};
    std::uint64_t frames = 0; // all that were measured, where long runs keep some of their times; 0: those of frame_ms
    std::vector<double> frame_ms;
    std::vector<std::map<std::string, double>> cpu_ms, gpu_ms;
    gi::Report counters; // of the last frame
    std::map<std::string, std::uint64_t> memory;
    std::uint32_t render_passes = 0;
    float ev100 = viewer::default_exposure;
};
Json measurement_json(const gpu::Device& device, const Measurement& measurement);
using statistics::median;
using statistics::percentile;

// Prints "error: ..." once and returns exit_failed.
int fail(const Error& error);
// exit_done, or the message and `on_error`; where a signal ended the work, exit_stopped_by it.
int exit_status(const Status& status, int on_error = exit_failed);

using viewer::Progress;

// Seconds since it was made.
class Stopwatch {
public:
    double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count(); }

private:
    std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
};

// True once the user pressed Ctrl-C, or the program was asked to end by another signal (engine/core/stop_signals.h).
bool interrupted();

} // namespace sunfleck::command_line

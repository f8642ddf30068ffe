// A run of steps alone: the solution or a recording, without pictures or a device.
#include "engine/core/stop_signals.h"
#include "game_demo/game/solution_run.h"
#include "game_demo/options.h"
#include "viewer/built_in_scenes.h"

namespace sunfleck::demo {

Status run_simulation(const Options& options) {
    if (options.output.empty())
        return Error{"--simulate needs a folder for stats.json: -o DIR"};
    SUNFLECK_ASSIGN(const std::filesystem::path scene, viewer::find_scene(options.scene));
    watch_stop_signals();
    return run_solution({scene, options.input, options.record, options.output, options.allow_outside, options.sensors});
}

} // namespace sunfleck::demo

// A run of steps alone: the solution or a recording, without pictures or a device.
#include "engine/core/output.h"
#include "game_demo/game/checkpoint_files.h"
#include "game_demo/game/solution_run.h"
#include "game_demo/options.h"
#include "viewer/built_in_scenes.h"

namespace sunfleck::demo {

Status run_simulation(const Options& options) {
    if (options.output.empty())
        return Error{"--simulate needs a folder for stats.json: -o DIR"};
    SUNFLECK_ASSIGN(const std::filesystem::path scene, viewer::find_scene(options.scene));
    std::error_code code;
    std::filesystem::create_directories(options.output, code);
    if (code)
        return Error{"cannot create folder '" + options.output + "': " + code.message()};
    const NamedFile outputs[] = {{"-o", std::filesystem::path(options.output) / "stats.json"},
                                 {"--record", options.record}};
    const NamedFile inputs[] = {{"--input", options.input}, {"--scene", scene}};
    SUNFLECK_TRY(try_outputs(outputs, inputs));
    return run_solution({scene, identity_of_level(options.scene), options.input, options.record, options.output,
                         options.allow_outside, options.sensors});
}

} // namespace sunfleck::demo

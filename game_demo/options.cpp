#include "game_demo/options.h"

#include "engine/core/output.h"

namespace sunfleck::demo {

Status check_window_files(const Options& options) {
    const NamedFile outputs[] = {
        {"--record", options.record}, {"--settings", options.settings_file}, {"--state", options.state}};
    const NamedFile inputs[] = {{"--scene", options.scene}};
    SUNFLECK_TRY(check_outputs(outputs, inputs));
    return options.record.empty() ? Status() : try_output(options.record);
}

} // namespace sunfleck::demo

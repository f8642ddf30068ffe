#include "game_demo/options.h"

#include "engine/core/output.h"

namespace sunfleck::demo {

Status check_window_files(const Options& options) {
    const NamedFile outputs[] = {
        {"--record", options.record}, {"--settings", options.settings_file}, {"--state", options.state}};
    const NamedFile inputs[] = {{"--scene", options.scene}};
    // Settings make the folder that they lie in.
    std::error_code code;
    if (const std::filesystem::path settings = options.settings_file; settings.has_parent_path())
        std::filesystem::create_directories(settings.parent_path(), code);
    return try_outputs(outputs, inputs);
}

} // namespace sunfleck::demo

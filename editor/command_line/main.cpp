// The tool `sunfleck`.
#include "editor/command_line/program.h"

#include "engine/core/log.h"
#include "engine/core/output.h"

#include <csignal>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

namespace {

void install_log() {
    auto logger = spdlog::stderr_color_mt("sunfleck");
    logger->set_pattern("%^%l%$: %v");
    sunfleck::set_log_sink([logger](sunfleck::LogLevel level, std::string_view message) {
        static constexpr spdlog::level::level_enum levels[] = {spdlog::level::debug, spdlog::level::info,
                                                               spdlog::level::warn, spdlog::level::err};
        logger->log(levels[int(level)], message);
    });
}

} // namespace

int main(int argc, char** argv) {
    sunfleck::hold_standard_streams();
    install_log();
    std::signal(SIGXFSZ, SIG_IGN); // a file-size limit becomes a write error like any other
    return sunfleck::command_line::run_program(argc, argv);
}

// The tool `sunfleck`.
#include "editor/command_line/common.h"

#include "engine/core/log.h"

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
    using namespace sunfleck::command_line;
    install_log();
    std::signal(SIGXFSZ, SIG_IGN); // a file-size limit becomes a write error like any other
    CLI::App program("Sunfleck: real-time global illumination with hundreds of shadowed light samples.");
    program.require_subcommand(1);
    program.set_version_flag("--version", "sunfleck 0.1.0");
    program.footer("Example: sunfleck render cornell -o cornell.png --lights 300");
    const Command commands[] = {make_render_command(program), make_reference_command(program),
                                make_compare_command(program), make_bench_command(program), make_info_command(program)};
    try {
        program.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        const int status = program.exit(error);
        return status == 0 ? 0 : 2;
    }
    for (const Command& command : commands)
        if (command.app->parsed())
            return command.run();
    return 2;
}

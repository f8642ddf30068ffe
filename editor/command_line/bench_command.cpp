#include "editor/command_line/common.h"
namespace sunfleck::command_line {
Command make_bench_command(CLI::App& program) {
    CLI::App* app = program.add_subcommand("bench", "Runs a named experiment");
    return {app, [] { return 1; }};
}
} // namespace sunfleck::command_line

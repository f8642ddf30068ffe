// The tool `sunfleck` as a function, for its main and for tests that add a technique first.
#pragma once

#include <string>

namespace sunfleck::command_line {

// Reads the command line (argv[0] is the program's name), runs the command and returns the exit status
// (engine/core/exit_status.h).
int run_program(int argc, const char* const* argv);
// Only reads it: exit_done or exit_usage, and what would be printed.
int check_command_line(int argc, const char* const* argv, std::string& message);

} // namespace sunfleck::command_line

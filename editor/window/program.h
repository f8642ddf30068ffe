// The editor as a program: its command line.
#pragma once

#include <iosfwd>
#include <optional>

namespace sunfleck::editor {

struct Options;
// Reads the command line (argv[0] is the program's name). The exit status where there is nothing to run: help was asked
// for, or the command line is wrong.
std::optional<int> read_command_line(int argc, const char* const* argv, Options& options, std::ostream& out,
                                     std::ostream& errors);
// What main returns.
int run_program(int argc, char** argv);

} // namespace sunfleck::editor

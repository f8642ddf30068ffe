// The demo's command line.
#pragma once

#include "game_demo/options.h"

#include <iosfwd>

namespace sunfleck::demo {

// Reads it (argv[0] is the program's name). The exit status where there is nothing to run: help was asked for, or the
// command line is wrong.
std::optional<int> read_command_line(int argc, const char* const* argv, Options& options, std::ostream& out,
                                     std::ostream& errors);

} // namespace sunfleck::demo

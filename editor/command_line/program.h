// The tool `sunfleck` as a function, for its main and for tests that add a technique first.
#pragma once

namespace sunfleck::command_line {

// Reads the command line (argv[0] is the program's name), runs the command and returns the exit status: 0, 1 after a
// failure, 2 where the command line is wrong.
int run_program(int argc, const char* const* argv);

} // namespace sunfleck::command_line

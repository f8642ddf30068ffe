// The editor as a program: its command line.
#pragma once

namespace sunfleck::editor {

// What main returns.
int run_program(int argc, char** argv);

} // namespace sunfleck::editor

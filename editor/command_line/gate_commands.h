// `bench level` and `bench compare`: their options. The rest of the command line is in program.cpp.
#pragma once

#include <functional>
#include <vector>

namespace CLI {
class App;
}

namespace sunfleck::command_line {

// Adds both to `bench`. Calls what was chosen, if one was; its exit status comes back in `status`.
std::function<bool(int& status)> add_gate_commands(CLI::App& bench);

} // namespace sunfleck::command_line

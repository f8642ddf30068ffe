// The tool as it was at a revision of the project, built into a folder of its own.
#pragma once

#include "editor/gate/child_process.h"

#include <filesystem>

namespace sunfleck::gate {

// Runs a command to its end; an exit status other than 0 is an error with the last lines that it wrote. The output is
// both of its streams.
Result<std::string> run_command(const std::vector<std::string>& arguments, const Patience& patience);

// The folder of the project that the current folder lies in.
Result<std::filesystem::path> project_root(const Patience& patience);

// Builds the program `sunfleck` of `revision` (any name that git knows) under build/gate of the project, unless it is
// there already, and returns its path. Tests are not built; the compiler cache helps.
Result<std::filesystem::path> build_revision(const std::string& revision, const Patience& patience,
                                             const std::function<void(const std::string&)>& say);

} // namespace sunfleck::gate

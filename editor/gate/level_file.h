// Files of `bench level`: a weaker way to compare, when the programs themselves can't run side by side.
#pragma once

#include "editor/gate/gate_run.h"

namespace sunfleck::gate {

struct LevelFile {
    Hello hello;
    std::vector<Frame> frames;
};
Result<LevelFile> read_level_file(const std::filesystem::path& path);

// Twelve stretches of the recording stand for pairs. One process of each, at different times: the luck of a process and
// the machine's drift are not averaged out, so only what is far beyond them counts.
Result<GateRun> compare_files(const std::filesystem::path& base, const std::filesystem::path& head,
                              const std::set<std::string>& accepted_counters);

} // namespace sunfleck::gate

// sunfleck bench compare: the frame-time gate.
#pragma once

#include "editor/command_line/level_run.h"
#include "editor/gate/gate_run.h"

namespace sunfleck::command_line {

struct CompareRunOptions {
    std::string base, head;
    LevelOptions level; // handed to programs that are given without arguments
    std::vector<std::string> accepted_counters;
    double time_limit = 300.0; // s
    std::vector<std::uint32_t> looks = {12, 20, 32, 48};
    gate::PairOptions pair;
    bool skip_work = false;
};

Result<gate::Outcome> bench_compare(const CompareRunOptions& options);

} // namespace sunfleck::command_line

// A gate's verdict in words, for the terminal and the report.
#pragma once

#include "editor/gate/gate_run.h"

namespace sunfleck::gate {

// "slower: 'shadow maps' takes 1.051 times as long ..."
std::string headline(const GateRun& run);
// Sentences on the cause, on counters and on what limits the verdict; one each.
std::vector<std::string> remarks(const GateRun& run);
// Rows that are worth showing, the slowest first.
std::vector<statistics::GateRow> sorted_rows(const statistics::GateReport& report);
const char* kind_text(const statistics::GateRow& row);
// All of it.
std::string verdict_text(const GateRun& run);

} // namespace sunfleck::gate

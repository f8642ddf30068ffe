// The gate's report as one HTML file that needs nothing else: no network, and no scripts to be read.
#pragma once

#include "editor/gate/gate_run.h"

namespace sunfleck::gate {

Status write_html_report(const std::filesystem::path& path, const GateRun& run);

} // namespace sunfleck::gate

// Pictures of numbers as SVG, for the report.
#pragma once

#include "editor/gate/gate_run.h"

namespace sunfleck::gate {

std::string escape_html(const std::string& text);
// A number for an attribute or a cell.
std::string decimal(double value, int digits);

// One row's ratio with its interval, on a scale that all rows share.
std::string interval_plot(const statistics::GateRow& row, double scale);
// Every pair's ratio of a row, a dot each.
std::string pairs_plot(const std::vector<double>& log_ratios, double scale);
// Times of the frames over the recording, base and head.
std::string frame_times_plot(const std::vector<FrameTime>& times);

} // namespace sunfleck::gate

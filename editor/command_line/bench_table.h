// Benchmark results, printed or written as JSON, CSV or a plot.
#pragma once

#include "editor/command_line/common.h"

#include <nlohmann/json.hpp>

namespace sunfleck::command_line {

struct BenchTable {
    std::string suite;
    std::vector<Json> rows; // one object each, all with the same keys
    Json notes = Json::object();

    void print() const;
    Json json(const gpu::Device* device) const;
    std::string csv() const;
};

struct PlotSeries {
    std::string name;
    std::vector<std::pair<double, double>> points;
};

// A log-log line plot as SVG.
std::string plot_svg(const std::string& title, const std::string& x_label, const std::string& y_label,
                     const std::vector<PlotSeries>& series);

// Slope of the least-squares line through log(y) over log(x).
double log_log_slope(const std::vector<std::pair<double, double>>& points);

} // namespace sunfleck::command_line

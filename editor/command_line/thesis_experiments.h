// Common parts of the thesis's experiments. All rows have the same columns: what was varied, times, and a note.
#pragma once

#include "editor/command_line/bench_runner.h"

namespace sunfleck::command_line {

inline constexpr Size thesis_size{1024, 768};
inline const std::vector<std::string> thesis_scenes = {"area_room", "table_room", "four_pillars"};
inline const std::map<std::string, std::vector<std::string>> thesis_cameras = {
    {"area_room", {"bench_1", "bench_2"}},
    {"table_room", {"bench_1", "bench_2"}},
    {"four_pillars", {"bench_1", "bench_2"}}};

struct Experiment {
    const BenchOptions& options;
    BenchTable& table;

    // A row of times.
    void row(const std::string& figure, const std::string& scene, const std::string& what, double x,
             const Measurement& m, const std::string& note = "");
    // A row of one other value.
    void value(const std::string& figure, const std::string& scene, const std::string& what, double x, double value,
               const std::string& note);
};

// Settings of the two systems that are compared.
gi::Settings many_light(std::uint32_t lights);
gi::Settings brute_force(std::uint32_t lights);
// Frames after which every map has been drawn once.
std::uint32_t warm_up(const gi::Settings& settings);

// Median of a frame's GPU time without the host's own passes.
double lighting_ms(const Measurement& measurement);
double cpu_median(const Measurement& measurement, const std::string& stage);

// Frame times: ratios of brute force to the full system and the first frames, by number of samples (fig. 5-2), with the
// techniques enabled one by one (fig. 5-3), and with constant map memory.
Status time_ratios(Experiment& experiment);
Status time_first_frames(Experiment& experiment);
Status frame_time_by_samples(Experiment& experiment, std::vector<PlotSeries>& plot);
Status ablation(Experiment& experiment);
Status scaling(Experiment& experiment, std::vector<PlotSeries>& plot);
// Shadow maps: redrawn per frame (fig. 5-4 to 5-6), render passes (fig. 4-11, 4-12), and visibility tests of 100
// movers.
Status map_updates(Experiment& experiment);
Status render_passes(Experiment& experiment);
Status many_movers(Experiment& experiment);
// Pictures: shadows that lag (fig. 4-16), the low-resolution pass, and the resolution of shadow maps (fig. 5-8).
Status lagging_shadows(Experiment& experiment);
Status resolution_errors(Experiment& experiment);
Status map_quality(Experiment& experiment);

} // namespace sunfleck::command_line

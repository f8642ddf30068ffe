// sunfleck bench thesis: the list of its experiments, and what they have in common.
#include "editor/command_line/thesis_experiments.h"

#include <algorithm>

namespace sunfleck::command_line {

gi::Settings many_light(std::uint32_t lights) {
    gi::Settings settings;
    settings.lights = lights;
    return settings;
}

gi::Settings brute_force(std::uint32_t lights) {
    gi::Settings settings = gi::Settings().all_light_by("brute_force");
    settings.lights = lights;
    return settings;
}

double lighting_ms(const Measurement& measurement) {
    std::vector<double> values;
    for (const auto& frame : measurement.gpu_ms) {
        double sum = 0;
        for (const auto& [pass, time] : frame)
            sum += pass == "g-buffer" || pass == "composition" || pass == "hand over" ? 0.0 : time;
        values.push_back(sum);
    }
    return median(values);
}

double cpu_median(const Measurement& measurement, const std::string& stage) {
    std::vector<double> values;
    for (const auto& frame : measurement.cpu_ms)
        if (const auto found = frame.find(stage); found != frame.end())
            values.push_back(found->second);
    return values.empty() ? 0.0 : median(values);
}

void Experiment::row(const std::string& figure, const std::string& scene, const std::string& what, double x,
                     const Measurement& m, const std::string& note) {
    table.rows.push_back({{"figure", figure},
                          {"scene", scene},
                          {"case", what},
                          {"x", x},
                          {"frame_ms", median(m.frame_ms)},
                          {"frame_ms_p95", percentile(m.frame_ms, 0.95)},
                          {"lighting_ms", lighting_ms(m)},
                          {"shadow_maps_ms", Bench::gpu_median(m, "shadow maps")},
                          {"visibility_ms", cpu_median(m, "visibility")},
                          {"value", 0.0},
                          {"note", note}});
}

void Experiment::value(const std::string& figure, const std::string& scene, const std::string& what, double x,
                       double value, const std::string& note) {
    table.rows.push_back({{"figure", figure},
                          {"scene", scene},
                          {"case", what},
                          {"x", x},
                          {"frame_ms", 0.0},
                          {"frame_ms_p95", 0.0},
                          {"lighting_ms", 0.0},
                          {"shadow_maps_ms", 0.0},
                          {"visibility_ms", 0.0},
                          {"value", value},
                          {"note", note}});
}

std::uint32_t warm_up(const gi::Settings& settings) {
    return settings.lights / std::max(settings.map_budget, 1u) + 3;
}

namespace {

struct Part {
    const char* name;
    double share; // approximate fraction of the total run time; 0: another part has it, so that it runs by name only
    Status (*run)(Experiment& experiment, std::vector<PlotSeries>& plot);
};

const Part parts[] = {
    {"ratios", 0.3,
     [](Experiment& e, std::vector<PlotSeries>&) -> Status {
         SUNFLECK_TRY(time_ratios(e));
         return time_first_frames(e); // which the ratios leave out
     }},
    {"first_frames", 0.0, [](Experiment& e, std::vector<PlotSeries>&) { return time_first_frames(e); }},
    {"samples", 0.1, [](Experiment& e, std::vector<PlotSeries>& plot) { return frame_time_by_samples(e, plot); }},
    {"ablation", 0.1, [](Experiment& e, std::vector<PlotSeries>&) { return ablation(e); }},
    {"map_updates", 0.2, [](Experiment& e, std::vector<PlotSeries>&) { return map_updates(e); }},
    {"scaling", 0.05, [](Experiment& e, std::vector<PlotSeries>& plot) { return scaling(e, plot); }},
    {"passes", 0.05, [](Experiment& e, std::vector<PlotSeries>&) { return render_passes(e); }},
    {"movers", 0.05, [](Experiment& e, std::vector<PlotSeries>&) { return many_movers(e); }},
    {"lag", 0.05, [](Experiment& e, std::vector<PlotSeries>&) { return lagging_shadows(e); }},
    {"low_resolution", 0.05, [](Experiment& e, std::vector<PlotSeries>&) { return resolution_errors(e); }},
    {"quality", 0.05, [](Experiment& e, std::vector<PlotSeries>&) { return map_quality(e); }},
};

} // namespace

std::vector<std::string> thesis_parts() {
    std::vector<std::string> names;
    for (const Part& part : parts)
        names.emplace_back(part.name);
    return names;
}

Result<BenchTable> bench_thesis(const BenchOptions& options, std::vector<PlotSeries>& plot) {
    BenchTable table{"thesis", {}, {}};
    Experiment experiment{options, table};
    Progress progress("bench thesis");
    double done = 0.0;
    for (const Part& part : parts) {
        if (options.part.empty() ? part.share == 0.0 : options.part != part.name)
            continue;
        SUNFLECK_TRY(part.run(experiment, plot));
        done += part.share;
        progress.show(options.part.empty() ? done : 1.0, "");
        if (interrupted())
            return Error{"interrupted"};
    }
    return table;
}

} // namespace sunfleck::command_line

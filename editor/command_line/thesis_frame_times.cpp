// Frame times of the thesis's experiments.
#include "editor/command_line/thesis_experiments.h"

namespace sunfleck::command_line {

Status frame_time_by_samples(Experiment& experiment, std::vector<PlotSeries>& plot) {
    for (const std::string& scene : thesis_scenes) {
        SUNFLECK_ASSIGN(const auto bench, Bench::create(experiment.options, scene, "bench_1", thesis_size));
        PlotSeries series{scene, {}};
        for (const std::uint32_t lights : {32u, 64u, 128u, 300u, 512u, 1024u}) {
            const gi::Settings settings = many_light(lights);
            SUNFLECK_ASSIGN(const Measurement m,
                            bench->measure(settings, warm_up(settings), experiment.options.repeat, true));
            experiment.row("5-2", scene, "full system", lights, m, "thesis: linear, interactive up to 300");
            series.points.push_back({double(lights), median(m.frame_ms)});
        }
        plot.push_back(series);
    }
    return {};
}

Status ablation(Experiment& experiment) {
    SUNFLECK_ASSIGN(const auto bench, Bench::create(experiment.options, "area_room", "bench_1", thesis_size));
    for (const std::uint32_t lights : {2u, 32u, 100u, 300u}) {
        gi::Settings step = many_light(lights);
        for (const char* part : {"visibility", "light_maps", "static_maps", "map_detail", "baked_light"})
            step.with(part, "off");
        step.low_resolution = 1;
        const auto measure = [&](const gi::Settings& settings, const char* what) -> Status {
            SUNFLECK_ASSIGN(const Measurement m,
                            bench->measure(settings, warm_up(settings), experiment.options.repeat, true));
            experiment.row("5-3", "area_room", what, lights, m);
            return {};
        };
        SUNFLECK_TRY(measure(brute_force(lights), "naive"));
        step.with("visibility", "on");
        SUNFLECK_TRY(measure(step, "+ visibility"));
        step.low_resolution = 4;
        SUNFLECK_TRY(measure(step, "+ low resolution"));
        step.with("light_maps", "on");
        SUNFLECK_TRY(measure(step, "+ light maps"));
        step.static_maps = step.map_detail = true;
        SUNFLECK_TRY(measure(step, "+ cached static maps, detail"));
        SUNFLECK_TRY(measure(many_light(lights), "full (+ baked light)"));
    }
    return {};
}

// Constant map memory and maps per frame: resolution falls as the number of samples grows.
Status scaling(Experiment& experiment, std::vector<PlotSeries>& plot) {
    SUNFLECK_ASSIGN(const auto bench, Bench::create(experiment.options, "four_pillars", "bench_1", thesis_size));
    PlotSeries series{"four_pillars, equal map memory", {}};
    for (const std::uint32_t lights : {256u, 512u, 1024u, 2048u, 4096u}) {
        gi::Settings settings = many_light(lights);
        settings.shadow_memory = 75.0f;
        settings.map_budget = 100;
        SUNFLECK_ASSIGN(const Measurement m,
                        bench->measure(settings, warm_up(settings), experiment.options.repeat, true));
        experiment.row("scaling", "four_pillars", "75 MiB of maps, 100 maps per frame", lights, m);
        series.points.push_back({double(lights), median(m.frame_ms)});
    }
    experiment.value("scaling", "four_pillars", "growth from 256 to 4096", 0,
                     series.points.back().second / series.points.front().second, "target: at most 8");
    experiment.value("scaling", "four_pillars", "fitted exponent", 0, log_log_slope(series.points), "");
    plot.push_back(series);
    return {};
}

} // namespace sunfleck::command_line

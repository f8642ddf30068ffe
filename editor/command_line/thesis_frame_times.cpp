// Frame times of the thesis's experiments.
#include "editor/command_line/thesis_experiments.h"

#include <algorithm>
#include <cstdio>

namespace sunfleck::command_line {
namespace {

// The median, with minimum and maximum in the note.
void spread_row(Experiment& experiment, const std::string& where, const char* what, double x,
                const std::vector<double>& ratios, const char* note) {
    char text[160];
    std::snprintf(text, sizeof text, "%.1f to %.1f in %zu turns; %s", *std::min_element(ratios.begin(), ratios.end()),
                  *std::max_element(ratios.begin(), ratios.end()), ratios.size(), note);
    experiment.value("ratio", where, what, x, median(ratios), text);
}

void append(Measurement& all, const Measurement& part) {
    all.frame_ms.insert(all.frame_ms.end(), part.frame_ms.begin(), part.frame_ms.end());
    all.gpu_ms.insert(all.gpu_ms.end(), part.gpu_ms.begin(), part.gpu_ms.end());
    all.cpu_ms.insert(all.cpu_ms.end(), part.cpu_ms.begin(), part.cpu_ms.end());
    all.counters = part.counters;
}

// Interleaves brute force and the full system, because shared machines change speed within seconds: each ratio is of
// two consecutive measurements, and the median of the ratios is reported.
Status ratios(Experiment& experiment, const std::string& scene, const std::string& camera, std::uint32_t lights) {
    SUNFLECK_ASSIGN(const auto bench, Bench::create(experiment.options, scene, camera, thesis_size));
    Measurement all_brute, all_full;
    std::vector<double> whole_ratios, lighting_ratios;
    for (int turn = 0; turn < 5; ++turn) {
        SUNFLECK_ASSIGN(const Measurement brute, bench->measure(brute_force(lights), 1, 2, true));
        SUNFLECK_ASSIGN(const Measurement full, bench->measure(many_light(lights), warm_up(many_light(lights)),
                                                               experiment.options.repeat, true));
        whole_ratios.push_back(median(brute.frame_ms) / median(full.frame_ms));
        lighting_ratios.push_back(lighting_ms(brute) / lighting_ms(full));
        append(all_brute, brute);
        append(all_full, full);
    }
    const std::string where = scene + " " + camera;
    experiment.row("ratio", where, "brute force", lights, all_brute);
    experiment.row("ratio", where, "full system", lights, all_full);
    spread_row(experiment, where, "whole frame", lights, whole_ratios,
               "brute force over full; target 10 at 300, 15 at 1024");
    spread_row(experiment, where, "lighting", lights, lighting_ratios, "brute force over full; target 15 at 300");
    return {};
}

} // namespace

Status time_ratios(Experiment& experiment) {
    for (const std::string& scene : thesis_scenes)
        for (const std::string& camera : thesis_cameras.at(scene))
            SUNFLECK_TRY(ratios(experiment, scene, camera, 300));
    return ratios(experiment, "four_pillars", "bench_1", 1024);
}

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

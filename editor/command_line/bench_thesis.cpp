// sunfleck bench thesis: the experiments of the thesis's chapter 5 and of fig. 4-11 and 4-12. Every ratio's two sides
// take turns in one run. The rows of all experiments have one form: what was varied, times, and what the row is about.
#include "editor/command_line/bench_runner.h"
#include "gi_module/many_light/many_light_settings.h"

#include "editor/command_line/metrics.h"
#include "engine/scene/procedural.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace sunfleck::command_line {
namespace {

constexpr Size size{1024, 768};
const std::vector<std::string> scenes = {"area_room", "table_room", "four_pillars"};
const std::map<std::string, std::vector<std::string>> cameras = {{"area_room", {"bench_1", "bench_2"}},
                                                                 {"table_room", {"bench_1", "bench_2"}},
                                                                 {"four_pillars", {"bench_1", "bench_2"}}};

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

// Everything on the GPU but the host's own passes.
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

struct Experiment {
    const BenchOptions& options;
    BenchTable& table;

    void row(const std::string& figure, const std::string& scene, const std::string& what, double x,
             const Measurement& m, const std::string& note = "") {
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
    void value(const std::string& figure, const std::string& scene, const std::string& what, double x, double value,
               const std::string& note) {
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
};

// Frames after which every map has been drawn once.
std::uint32_t warm_up(const gi::Settings& settings) {
    return settings.lights / std::max(settings.map_budget, 1u) + 3;
}

// Median, and the lowest and the highest beside it.
void spread_row(Experiment& experiment, const std::string& where, const char* what, double x,
                const std::vector<double>& ratios, const char* note) {
    char text[160];
    std::snprintf(text, sizeof text, "%.1f to %.1f in %zu turns; %s", *std::min_element(ratios.begin(), ratios.end()),
                  *std::max_element(ratios.begin(), ratios.end()), ratios.size(), note);
    experiment.value("ratio", where, what, x, median(ratios), text);
}

// Brute force and the full system by turns. Machines that are shared change their speed within seconds: a ratio is of
// neighbours in time, and of those the median counts.
Status ratios(Experiment& experiment, const std::string& scene, const std::string& camera, std::uint32_t lights) {
    SUNFLECK_ASSIGN(const auto bench, Bench::create(experiment.options, scene, camera, size));
    Measurement all_brute, all_full;
    const auto join = [](Measurement& all, const Measurement& part) {
        all.frame_ms.insert(all.frame_ms.end(), part.frame_ms.begin(), part.frame_ms.end());
        all.gpu_ms.insert(all.gpu_ms.end(), part.gpu_ms.begin(), part.gpu_ms.end());
        all.cpu_ms.insert(all.cpu_ms.end(), part.cpu_ms.begin(), part.cpu_ms.end());
        all.counters = part.counters;
    };
    std::vector<double> whole_ratios, lighting_ratios;
    for (int turn = 0; turn < 5; ++turn) {
        SUNFLECK_ASSIGN(const Measurement brute, bench->measure(brute_force(lights), 1, 2, true));
        SUNFLECK_ASSIGN(const Measurement full, bench->measure(many_light(lights), warm_up(many_light(lights)),
                                                               experiment.options.repeat, true));
        whole_ratios.push_back(median(brute.frame_ms) / median(full.frame_ms));
        lighting_ratios.push_back(lighting_ms(brute) / lighting_ms(full));
        join(all_brute, brute);
        join(all_full, full);
    }
    const std::string where = scene + " " + camera;
    experiment.row("ratio", where, "brute force", lights, all_brute);
    experiment.row("ratio", where, "full system", lights, all_full);
    spread_row(experiment, where, "whole frame", lights, whole_ratios,
               "brute force over full; target 10 at 300, 15 at 1024");
    spread_row(experiment, where, "lighting", lights, lighting_ratios, "brute force over full; target 15 at 300");
    return {};
}

Status frame_time_over_samples(Experiment& experiment, std::vector<PlotSeries>& plot) {
    for (const std::string& scene : scenes) {
        SUNFLECK_ASSIGN(const auto bench, Bench::create(experiment.options, scene, "bench_1", size));
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
    SUNFLECK_ASSIGN(const auto bench, Bench::create(experiment.options, "area_room", "bench_1", size));
    for (const std::uint32_t lights : {2u, 32u, 100u, 300u}) {
        gi::Settings step = many_light(lights);
        step.of<gi::ManyLightSettings>().visibility = step.of<gi::ManyLightSettings>().light_maps = step.static_maps =
            step.map_detail = step.of<gi::ManyLightSettings>().baked_light = false;
        step.low_resolution = 1;
        const auto measure = [&](const gi::Settings& settings, const char* what) -> Status {
            SUNFLECK_ASSIGN(const Measurement m,
                            bench->measure(settings, warm_up(settings), experiment.options.repeat, true));
            experiment.row("5-3", "area_room", what, lights, m);
            return {};
        };
        SUNFLECK_TRY(measure(brute_force(lights), "naive"));
        step.of<gi::ManyLightSettings>().visibility = true;
        SUNFLECK_TRY(measure(step, "+ visibility"));
        step.low_resolution = 4;
        SUNFLECK_TRY(measure(step, "+ low resolution"));
        step.of<gi::ManyLightSettings>().light_maps = true;
        SUNFLECK_TRY(measure(step, "+ light maps"));
        step.static_maps = step.map_detail = true;
        SUNFLECK_TRY(measure(step, "+ kept static maps, detail"));
        SUNFLECK_TRY(measure(many_light(lights), "full (+ baked light)"));
    }
    return {};
}

// Fig. 5-4 to 5-6: maps a frame, with one of the scene's movers or all. Frames: eight times --repeat (the thesis: 200).
Status map_updates(Experiment& experiment) {
    struct Case {
        const char *scene, *keep, *note;
    };
    for (const Case& c : {Case{"four_pillars", "torus", "820 vertices"}, Case{"four_pillars", "knot", "3,000 vertices"},
                          Case{"table_room", "knot", "3,000 vertices"}}) {
        SUNFLECK_ASSIGN(const auto bench, Bench::create(experiment.options, c.scene, "bench_1", size));
        ecs::Registry& registry = bench->renderer->registry();
        std::vector<ecs::Entity> others;
        registry.view<scene::Mover, scene::Name>().each(
            [&](ecs::Entity entity, const scene::Mover&, const scene::Name& name) {
                if (name.name != c.keep)
                    others.push_back(entity);
            });
        for (const ecs::Entity entity : others)
            registry.destroy(entity);
        for (const std::uint32_t budget : {0u, 25u, 50u, 100u, 200u, 300u}) {
            gi::Settings settings = many_light(300);
            settings.map_budget = budget;
            SUNFLECK_ASSIGN(const Measurement m,
                            bench->measure(settings, 6, experiment.options.repeat * 8, budget > 0));
            experiment.row("5-4", c.scene, std::string(c.keep) + ", maps a frame", budget, m, c.note);
            const double frame = median(m.frame_ms);
            experiment.value("5-6", c.scene, std::string(c.keep) + ", share of maps and visibility", budget,
                             (Bench::gpu_median(m, "shadow maps") + Bench::gpu_median(m, "shadow map copies") +
                              cpu_median(m, "visibility")) /
                                 frame,
                             "thesis: maps dominate at high counts");
            if (budget == 100)
                experiment.value("5-5", c.scene, std::string(c.keep) + ", vertices a map", budget,
                                 double(m.counters["shadow_map_vertices"]) / double(m.counters["shadow_map_updates"]),
                                 c.note);
        }
        if (c.scene == std::string("four_pillars") && c.keep == std::string("knot")) {
            SUNFLECK_ASSIGN(const Measurement brute, bench->measure(brute_force(300), 1, 3, true));
            gi::Settings settings = many_light(300);
            settings.map_budget = 100;
            SUNFLECK_ASSIGN(const Measurement full, bench->measure(settings, 6, experiment.options.repeat, true));
            experiment.value("ratio", c.scene, "one complex mover, 100 maps a frame", 300,
                             median(brute.frame_ms) / median(full.frame_ms), "target 6");
        }
    }
    return {};
}

// Equal maps a frame and equal memory for maps: maps shrink as samples multiply.
Status scaling(Experiment& experiment, std::vector<PlotSeries>& plot) {
    SUNFLECK_ASSIGN(const auto bench, Bench::create(experiment.options, "four_pillars", "bench_1", size));
    PlotSeries series{"four_pillars, equal map memory", {}};
    for (const std::uint32_t lights : {256u, 512u, 1024u, 2048u, 4096u}) {
        gi::Settings settings = many_light(lights);
        settings.shadow_memory = 75.0f;
        settings.map_budget = 100;
        SUNFLECK_ASSIGN(const Measurement m,
                        bench->measure(settings, warm_up(settings), experiment.options.repeat, true));
        experiment.row("scaling", "four_pillars", "75 MiB of maps, 100 maps a frame", lights, m);
        series.points.push_back({double(lights), median(m.frame_ms)});
    }
    experiment.value("scaling", "four_pillars", "growth from 256 to 4096", 0,
                     series.points.back().second / series.points.front().second, "target: at most 8");
    experiment.value("scaling", "four_pillars", "fitted exponent", 0, log_log_slope(series.points), "");
    plot.push_back(series);
    return {};
}

Status passes(Experiment& experiment) {
    const auto measure = [&](const std::string& scene, const std::string& camera, const char* figure) -> Status {
        SUNFLECK_ASSIGN(const auto bench, Bench::create(experiment.options, scene, camera, {64, 48}));
        gi::Settings settings = many_light(300);
        settings.of<gi::ManyLightSettings>().count_passes = true;
        settings.patch_levels = 3;
        const std::string where = scene + " " + camera;
        for (const bool extras : {false, true}) {
            settings.of<gi::ManyLightSettings>().pass_extras = extras;
            SUNFLECK_ASSIGN(const Measurement m, bench->measure(settings, 3, 1, true));
            const double before = double(m.counters["render_passes_unoptimised"]),
                         after = double(m.counters["render_passes"]);
            const std::string how = extras ? ", with harmless extras" : ", as the thesis";
            if (!extras)
                experiment.value(figure, where, "passes before", 7, before, "thesis fig. 4-12: 1563");
            experiment.value(figure, where, "passes after" + how, 7, after, "thesis fig. 4-12: 447");
            experiment.value(figure, where, "removed" + how, 7, 1.0 - after / std::max(before, 1.0),
                             "target 0.7 in fig. 4-12's view");
            if (extras)
                experiment.value(figure, where, "pairs drawn over needed", 7, m.counters["pass_fill"], "");
        }
        return {};
    };
    for (const std::string& scene : scenes)
        for (const std::string& camera : cameras.at(scene))
            SUNFLECK_TRY(measure(scene, camera, "4-11"));
    return measure("four_pillars", "pillar_close", "4-12");
}

// 100 moving boxes: how much clusters of samples and groups of patches save.
Status many_movers(Experiment& experiment) {
    SUNFLECK_ASSIGN(const auto bench, Bench::create(experiment.options, "four_pillars", "bench_1", {64, 48}));
    ecs::Registry& registry = bench->renderer->registry();
    const std::uint32_t mesh = bench->renderer->meshes().add(scene::make_box(vec3(0.25f)));
    SUNFLECK_TRY(bench->renderer->upload_meshes());
    for (int i = 0; i < 100; ++i) {
        const ecs::Entity entity = registry.create();
        scene::Mover mover;
        mover.path = scene::MoverPath::circle;
        mover.centre =
            vec3(float(i % 10) * 0.7f - 3.15f, 0.3f + float(i / 50) * 1.5f, float(i / 10 % 10) * 0.7f - 3.15f);
        mover.period = 4.0f + float(i % 7);
        scene::Transform transform;
        transform.position = mover.centre + vec3(0.3f, 0.0f, 0.0f);
        registry.emplace<scene::Transform>(entity, transform);
        registry.emplace<scene::MeshInstance>(entity, {mesh});
        registry.emplace<scene::Material>(entity);
        registry.emplace<scene::Mover>(entity, mover);
    }
    const char* const names[] = {"clusters", "trees", "pairs"};
    double tests[3], times[3], pairs = 1;
    for (const gi::TestGrouping grouping :
         {gi::TestGrouping::clusters, gi::TestGrouping::trees, gi::TestGrouping::pairs}) {
        const std::size_t i = std::size_t(grouping);
        gi::Settings settings = many_light(300);
        settings.visibility_tests = grouping;
        settings.map_budget = 1;
        SUNFLECK_ASSIGN(const Measurement m, bench->measure(settings, 2, experiment.options.repeat, true));
        tests[i] = double(m.counters["visibility_tests"]);
        times[i] = cpu_median(m, "visibility");
        pairs = 102.0 * 300.0 * double(m.counters["surface_patches"] + 102);
        experiment.row("movers", "four_pillars", std::string("102 movers, tests of ") + names[i], 300, m);
    }
    const auto report = [&](const char* what, double value, const char* note) {
        experiment.value("movers", "four_pillars", what, 300, value, note);
    };
    report("tests over movers x nodes x samples", tests[0] / pairs, "clusters; target: at most 0.1");
    report("tests over movers x nodes x samples", tests[1] / pairs, "trees");
    report("tests over movers x nodes x samples", tests[2] / pairs, "pairs");
    report("time over that of pairs", times[0] / times[2], "clusters; target: at most 0.2");
    report("time over that of trees", times[0] / times[1], "clusters");
    return {};
}

// Fig. 5-8: direct light by few samples and maps of several sizes, against 2,000 samples with the largest.
Status quality(Experiment& experiment) {
    SUNFLECK_ASSIGN(const auto bench, Bench::create(experiment.options, "area_room", "bench_1", {320, 240}));
    bench->request.view = shared::view_irradiance;
    bench->request.tone_map = false;
    const auto picture = [&](gi::Settings settings) -> Result<io::Picture> {
        settings.with("indirect", "none");
        SUNFLECK_TRY(bench->measure(settings, settings.get("direct") == "light_samples" ? 5 : 0, 1, false));
        return bench->renderer->read_back();
    };
    gi::Settings truth = brute_force(2000);
    truth.shadow_map_resolution = 512;
    truth.shadow_memory = 2048.0f;
    SUNFLECK_ASSIGN(const io::Picture reference, picture(truth));
    for (const std::uint32_t lights : {25u, 50u, 100u})
        for (const std::uint32_t resolution : {64u, 128u, 256u, 512u}) {
            gi::Settings settings = many_light(lights);
            settings.shadow_map_resolution = resolution;
            settings.clamp_scale = 2000.0f / float(lights); // the same bound for all
            settings.low_resolution = 1;                    // so small a picture would show little else
            SUNFLECK_ASSIGN(const io::Picture image, picture(settings));
            experiment.value("5-8", "area_room", "relative MSE, maps of " + std::to_string(resolution), lights,
                             compare_pictures(image, reference, true).relative_mean_square_error,
                             "direct light against 2,000 samples");
        }
    return {};
}

Status all_ratios(Experiment& experiment) {
    for (const std::string& scene : scenes)
        for (const std::string& camera : cameras.at(scene))
            SUNFLECK_TRY(ratios(experiment, scene, camera, 300));
    return ratios(experiment, "four_pillars", "bench_1", 1024);
}

struct Part {
    const char* name;
    double share; // of the whole run's time, about
    Status (*run)(Experiment& experiment, std::vector<PlotSeries>& plot);
};

const Part parts[] = {
    {"ratios", 0.3, [](Experiment& e, std::vector<PlotSeries>&) { return all_ratios(e); }},
    {"samples", 0.15, [](Experiment& e, std::vector<PlotSeries>& plot) { return frame_time_over_samples(e, plot); }},
    {"ablation", 0.15, [](Experiment& e, std::vector<PlotSeries>&) { return ablation(e); }},
    {"map_updates", 0.2, [](Experiment& e, std::vector<PlotSeries>&) { return map_updates(e); }},
    {"scaling", 0.05, [](Experiment& e, std::vector<PlotSeries>& plot) { return scaling(e, plot); }},
    {"passes", 0.05, [](Experiment& e, std::vector<PlotSeries>&) { return passes(e); }},
    {"movers", 0.05, [](Experiment& e, std::vector<PlotSeries>&) { return many_movers(e); }},
    {"quality", 0.05, [](Experiment& e, std::vector<PlotSeries>&) { return quality(e); }},
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
        if (!options.part.empty() && options.part != part.name)
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

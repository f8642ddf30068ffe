// What splatted light costs and what that buys: shadows of pixel lights, the cut of faint light, the paper's tables.
#include "editor/command_line/metrics.h"
#include "editor/command_line/splatting_experiments.h"
#include "engine/simulation/path_movers.h"
#include "gi_module/light_sampling/importance_warping.h"
#include "gi_module/reference/path_tracer.h"
#include "gi_module/splatting/splatting_shared.h"

#include <cmath>

namespace sunfleck::command_line {
namespace {

// The whole of the technique: maps, choice of lights, their shadows, light, reconstruction.
double splatting_ms(const Measurement& measurement) {
    return stage_ms(measurement, "pixel lights") +
           passes_ms(measurement, {"splat", "repair splat", "reconstruction", "compaction", "shadow maps of pixel"});
}

// The path tracer's first bounce, with movers at step 0.
Result<io::Picture> traced_first_bounce(Bench& bench, std::uint32_t samples) {
    viewer::SceneRenderer& renderer = *bench.renderer;
    simulation::set_movers_to_step(renderer.registry(), 0);
    SUNFLECK_TRY(renderer.rays().update(renderer.registry(), renderer.meshes()));
    const Bounds bounds = viewer::scene_bounds(renderer.registry(), renderer.meshes());
    const gi::reference::PathTracer tracer(renderer.rays(),
                                           gi::collect_emitters(renderer.registry(), renderer.meshes(), bounds));
    gi::reference::ReferenceSettings settings;
    settings.width = bench.request.width;
    settings.height = bench.request.height;
    settings.view = gi::reference::ReferenceView::indirect;
    settings.bounces = 1;
    gi::reference::Accumulation sums;
    tracer.accumulate(sums, bench.start, settings, samples);
    io::Picture picture{settings.width, settings.height, {}};
    for (std::size_t i = 0; i < sums.covered.size(); ++i)
        picture.pixels.emplace_back(
            vec3(float(sums.sums[i * 3]), float(sums.sums[i * 3 + 1]), float(sums.sums[i * 3 + 2])) / float(samples),
            sums.covered[i] ? 1.0f : 0.0f);
    return picture;
}

Status occlusion_row(SplatExperiment& experiment, Bench& bench, const io::Picture& truth, std::uint32_t count,
                     const char* occlusion) {
    const std::string what = std::to_string(count) + " lights, " + occlusion;
    SUNFLECK_TRY(bench.renderer->lighting().set_settings(splats_alone(count, occlusion)));
    SUNFLECK_ASSIGN(const io::Picture picture, splat_picture(bench, 0));
    const Metrics metrics = compare_pictures(picture, truth, true);
    experiment.row("arena", what, "truth error", metrics.relative_mean_square_error,
                   "target: maps at most a fifth of none");
    experiment.row("arena", what, "mean, relative", metrics.mean_a / metrics.mean_b - 1.0, "target: within 0.04");
    return {};
}

} // namespace

Status splat_occlusion(SplatExperiment& experiment) {
    SUNFLECK_ASSIGN(const auto bench, open_splat_scene(experiment.options, "arena", splat_picture_size));
    SUNFLECK_ASSIGN(const io::Picture truth, traced_first_bounce(*bench, 512));
    for (const std::uint32_t count : {256u, 1024u})
        for (const char* occlusion : {"none", "ambient", "maps"})
            SUNFLECK_TRY(occlusion_row(experiment, *bench, truth, count, occlusion));
    // Times: lamp and camera in motion, at a quarter of the resolution.
    SUNFLECK_ASSIGN(const auto timed, open_splat_scene(experiment.options, "arena", splat_time_size));
    timed->request.view = shared::view_final;
    timed->request.tone_map = true;
    for (const char* occlusion : {"none", "ambient", "maps"}) {
        gi::Settings settings = splats_alone(256, occlusion);
        settings.low_resolution = 4;
        SUNFLECK_ASSIGN(const Measurement m, timed->measure(settings, 20, 4 * experiment.options.repeat, true));
        const double g_buffer = passes_ms(m, {"g-buffer"}), all = splatting_ms(m);
        const std::string what = std::string("256 lights, ") + occlusion + ", lamp moving";
        experiment.row("arena", what, "G-buffer ms", g_buffer);
        experiment.row("arena", what, "CPU: maps, lights, shadows, ms", stage_ms(m, "pixel lights"));
        experiment.row("arena", what, "GPU: lists, light, reconstruction, ms", all - stage_ms(m, "pixel lights"));
        experiment.row("arena", what, "all over G-buffer", all / g_buffer, "target with maps: at most 2");
        experiment.row("arena", what, "rays for shadows", m.counters["splat_occlusion_rays"]);
    }
    return {};
}

namespace {

struct CutWay {
    const char* name;
    const char* levels;
    std::uint32_t scale;
};
constexpr CutWay cut_ways[] = {{"every pixel", "off", 1},
                               {"multiresolution", "on", 1},
                               {"every fourth pixel, interpolated and repaired", "off", 4}};

// Evaluations of a light at a pixel or a node, by the number of the picture's pixels, were all of them lit.
Result<double> evaluations_of(Bench& bench) {
    bench.request.lighting_view = "overdraw";
    SUNFLECK_ASSIGN(const io::Picture overdraw, splat_picture(bench, 0));
    bench.request.lighting_view.clear();
    double sum = 0.0;
    for (const vec4& pixel : overdraw.pixels)
        sum += double(pixel.x) * double(shared::most_overdraw) / double(overdraw.pixels.size());
    return sum;
}

// Light that is far from a flat piece of the picture, evaluated at few of its places instead of being cut.
Status multiresolution_rows(SplatExperiment& experiment, const char* scene) {
    SUNFLECK_ASSIGN(const auto bench, open_splat_scene(experiment.options, scene, splat_time_size));
    io::Picture whole;
    double all = 0.0, all_ms = 0.0;
    for (const CutWay& way : cut_ways) {
        gi::Settings settings = splats_alone(1024, "none");
        settings.low_resolution = way.scale;
        settings.with("splat_levels", way.levels);
        SUNFLECK_TRY(bench->renderer->lighting().set_settings(settings));
        SUNFLECK_ASSIGN(const io::Picture picture, splat_picture(*bench, 0));
        SUNFLECK_ASSIGN(double evaluations, evaluations_of(*bench));
        SUNFLECK_ASSIGN(Measurement m, bench->measure(settings, 2, experiment.options.repeat, true));
        if (way.scale > 1)
            evaluations *=
                1.0 / double(way.scale * way.scale) + m.counters["pixels_repaired"] / double(picture.pixels.size());
        const double ms = passes_ms(m, {"splat", "repair splat", "reconstruction", "compaction"});
        if (whole.pixels.empty()) {
            whole = picture;
            all = evaluations;
            all_ms = ms;
        }
        experiment.row(scene, way.name, "evaluations a pixel", evaluations);
        experiment.row(scene, way.name, "of every pixel's", evaluations / all,
                       "target of multiresolution: 0.125; gallery 0.2");
        experiment.row(scene, way.name, "relative MSE to every pixel's",
                       compare_pictures(picture, whole, true).relative_mean_square_error,
                       "target of multiresolution: 0.002");
        experiment.row(scene, way.name, "time of the passes, relative", ms / all_ms);
    }
    return {};
}

} // namespace

// Fig. 11: a threshold of irradiance, here relative to the mean of the picture's light.
Status splat_cutoff(SplatExperiment& experiment) {
    for (const char* scene : {"arena", "hall", "gallery"}) {
        SUNFLECK_ASSIGN(const auto bench, open_splat_scene(experiment.options, scene, splat_picture_size));
        io::Picture whole;
        double all = 0.0;
        for (const char* cutoff : {"0", "0.001", "0.003", "0.01", "0.03"}) {
            gi::Settings settings = splats_alone(1024, "none");
            settings.with("splat_cutoff", cutoff);
            SUNFLECK_TRY(bench->renderer->lighting().set_settings(settings));
            SUNFLECK_ASSIGN(const io::Picture picture, splat_picture(*bench, 0));
            SUNFLECK_ASSIGN(const double evaluations, evaluations_of(*bench));
            if (whole.pixels.empty()) {
                whole = picture;
                all = evaluations;
            }
            const std::string what = std::string("threshold ") + cutoff;
            experiment.row(scene, what, "evaluations a pixel", evaluations);
            experiment.row(scene, what, "of all", evaluations / all,
                           "paper, fig. 11: 1 %, 5 %, 7 % of I0: 14, 54, 74 fps");
            experiment.row(scene, what, "relative MSE to all",
                           compare_pictures(picture, whole, true).relative_mean_square_error);
        }
        SUNFLECK_TRY(multiresolution_rows(experiment, scene));
    }
    return {};
}

// Table 1: the ring's caustic, 4,096 glossy lights at 512 x 512.
Status splat_table1(SplatExperiment& experiment) {
    SUNFLECK_ASSIGN(const auto bench, open_splat_scene(experiment.options, "ring", {512, 512}));
    bench->request.view = shared::view_final;
    bench->request.tone_map = true;
    gi::Settings settings = splats_alone(256, "none").with("glossy_splats", "4096").with("splat_rays", "65536");
    settings.with("splat_warp", "b").with("splat_warp_levels", "3").with("splat_cutoff", "0.01");
    settings.low_resolution = 4;
    SUNFLECK_ASSIGN(const Measurement m, bench->measure(settings, 2, experiment.options.repeat, true));
    experiment.row("ring", "4,096 glossy lights, dynamic camera", "frame ms", median(m.frame_ms),
                   "paper, GeForce 6800 GT: 9.3 ms");
    experiment.row("ring", "4,096 glossy lights, dynamic camera", "GPU: lists, light, ms",
                   passes_ms(m, {"splat", "repair splat"}));
    SUNFLECK_TRY(bench->renderer->lighting().set_settings(settings.with("splat_rays", "65535")));
    SUNFLECK_ASSIGN(const Measurement first, bench->measure(settings.with("splat_rays", "65536"), 0, 1, true));
    experiment.row("ring", "4,096 glossy lights, new light", "frame ms", median(first.frame_ms),
                   "paper, dynamic light and camera: 10.4 ms");
    return {};
}

// Table 2: how long importance warping takes.
Status splat_table2(SplatExperiment& experiment) {
    constexpr double paper[2][2][4] = {{{0.123, 0.238, 0.541, 1.739}, {0.148, 0.358, 1.019, 3.484}},
                                       {{0.111, 0.183, 0.422, 1.274}, {0.125, 0.258, 0.754, 2.584}}};
    std::vector<float> values(64 * 64);
    for (std::size_t y = 0; y < 64; ++y)
        for (std::size_t x = 0; x < 64; ++x)
            values[y * 64 + x] = 1.0f + std::sin(0.1f * float(x)) * std::cos(0.2f * float(y));
    const gi::ImportanceMap map(values, 64);
    for (const gi::WarpMethod method : {gi::WarpMethod::a, gi::WarpMethod::b})
        for (const std::uint32_t side : {32u, 64u})
            for (std::uint32_t levels = 1; levels <= 4; ++levels) {
                std::vector<double> times;
                float sum = 0.0f; // so that nothing is left out
                for (std::uint32_t turn = 0; turn < 4 * experiment.options.repeat; ++turn) {
                    const Stopwatch watch;
                    for (std::uint32_t y = 0; y < side; ++y)
                        for (std::uint32_t x = 0; x < side; ++x)
                            sum += map.warp((vec2(float(x), float(y)) + 0.5f) / float(side), method, levels).weight;
                    times.push_back(1000.0 * watch.seconds());
                }
                char note[64];
                std::snprintf(note, sizeof note, "paper: %.3f ms; sum of weights %.4f of the samples",
                              paper[std::size_t(method)][side / 64][levels - 1],
                              double(sum) / double(side) / double(side) / double(times.size()));
                experiment.row("",
                               std::string(method == gi::WarpMethod::a ? "A" : "B") + ", " + std::to_string(side) +
                                   "^2 samples, levels " + std::to_string(levels),
                               "ms, one core", median(times), note);
            }
    return {};
}

// Table 3: 256 lights with and without ambient occlusion, the light at full and at half the size.
Status splat_table3(SplatExperiment& experiment) {
    SUNFLECK_ASSIGN(const auto bench, open_splat_scene(experiment.options, "arena", {512, 512}));
    bench->request.view = shared::view_final;
    bench->request.tone_map = true;
    constexpr int paper[2][2] = {{27, 37}, {63, 85}};
    for (const int size : {0, 1})
        for (const int ambient : {0, 1}) {
            gi::Settings settings = splats_alone(256, ambient ? "ambient" : "none").with("splat_cutoff", "0.01");
            settings.with("splat_pattern", "fixed").with("splat_importance", "none");
            settings.low_resolution = size == 0 ? 1 : 2;
            SUNFLECK_ASSIGN(const Measurement m, bench->measure(settings, 2, 2 * experiment.options.repeat, true));
            experiment.row("arena",
                           std::string(size == 0 ? "light at 512^2" : "light at 256^2") +
                               (ambient ? ", with ambient occlusion" : ", without"),
                           "frames a second", 1000.0 / median(m.frame_ms),
                           "paper: " + std::to_string(paper[size][ambient]));
        }
    return {};
}

} // namespace sunfleck::command_line

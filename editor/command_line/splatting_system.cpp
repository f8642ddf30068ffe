// Splatted light beside light samples: their error to the path tracer and their frame times, with a lamp in motion.
#include "editor/command_line/flicker_meter.h"
#include "editor/command_line/metrics.h"
#include "editor/command_line/splatting_experiments.h"
#include "engine/simulation/path_movers.h"
#include "gi_module/reference/path_tracer.h"

#include <cstdio>

namespace sunfleck::command_line {
namespace {

constexpr std::uint64_t system_step = 180; // the lamp is between two piers

// Irradiance of up to five bounces by the path tracer, with movers at that step.
Result<io::Picture> traced_light(Bench& bench, std::uint32_t samples) {
    viewer::SceneRenderer& renderer = *bench.renderer;
    simulation::set_movers_to_step(renderer.registry(), system_step);
    SUNFLECK_TRY(renderer.rays().update(renderer.registry(), renderer.meshes()));
    const Bounds bounds = viewer::scene_bounds(renderer.registry(), renderer.meshes());
    const gi::reference::PathTracer tracer(renderer.rays(),
                                           gi::collect_emitters(renderer.registry(), renderer.meshes(), bounds));
    gi::reference::ReferenceSettings settings;
    settings.width = bench.request.width;
    settings.height = bench.request.height;
    settings.view = gi::reference::ReferenceView::irradiance;
    gi::reference::Accumulation sums;
    tracer.accumulate(sums, bench.start, settings, samples);
    io::Picture picture{settings.width, settings.height, {}};
    for (std::size_t i = 0; i < sums.covered.size(); ++i)
        picture.pixels.emplace_back(
            vec3(float(sums.sums[i * 3]), float(sums.sums[i * 3 + 1]), float(sums.sums[i * 3 + 2])) / float(samples),
            sums.covered[i] ? 1.0f : 0.0f);
    return picture;
}

// How uneven the change from frame to frame is: of second differences, as FlickerMeter of first ones.
double unevenness(const std::vector<io::Picture>& frames) {
    FlickerMeter meter;
    for (std::size_t i = 0; i + 1 < frames.size(); ++i)
        meter.add(frames[i], frames[i + 1]);
    return meter.change();
}

Status system_row(SplatExperiment& experiment, Bench& bench, Bench& timed, const io::Picture& truth,
                  const std::string& what, const gi::Settings& settings) {
    gi::Settings every_pixel = settings;
    every_pixel.low_resolution = 1;
    SUNFLECK_TRY(bench.renderer->lighting().set_settings(every_pixel));
    std::vector<io::Picture> frames;
    for (std::uint64_t step = system_step - 30; step <= system_step; ++step) {
        SUNFLECK_ASSIGN(io::Picture picture, splat_picture(bench, step));
        if (step + 20 >= system_step)
            frames.push_back(std::move(picture));
    }
    SUNFLECK_ASSIGN(const Measurement m, timed.measure(settings, 20, 4 * experiment.options.repeat, true));
    experiment.row("arena", what, "truth error",
                   compare_pictures(frames.back(), truth, true).relative_mean_square_error,
                   "target: at most half of light samples'");
    experiment.row("arena", what, "unevenness from frame to frame", unevenness(frames), "target: at most a quarter");
    experiment.row("arena", what, "frame ms", median(m.frame_ms));
    return {};
}

} // namespace

Status splat_system(SplatExperiment& experiment) {
    SUNFLECK_ASSIGN(const auto bench, Bench::create(experiment.options, "arena", "bench_1", splat_picture_size));
    SUNFLECK_ASSIGN(const auto timed, Bench::create(experiment.options, "arena", "bench_1", splat_time_size));
    bench->request.view = shared::view_irradiance;
    bench->request.tone_map = false;
    SUNFLECK_ASSIGN(const io::Picture truth, traced_light(*bench, 256));
    for (const auto& [lights, share] : {std::pair{300u, 0.15f}, {300u, 0.3f}, {450u, 0.3f}, {450u, 0.5f}}) {
        gi::Settings settings;
        settings.lights = lights;
        settings.dynamic_share = share;
        char what[64];
        std::snprintf(what, sizeof what, "%u light samples, dynamic_share %.2f", lights, double(share));
        SUNFLECK_TRY(system_row(experiment, *bench, *timed, truth, what, settings));
    }
    for (const std::uint32_t splats : {128u, 256u}) {
        gi::Settings settings;
        settings.with("splat_lights", "moving").with("splats", std::to_string(splats));
        settings.with("splat_importance", "contribution");
        SUNFLECK_TRY(system_row(experiment, *bench, *timed, truth,
                                "300 light samples, " + std::to_string(splats) + " splats", settings));
    }
    return {};
}

} // namespace sunfleck::command_line

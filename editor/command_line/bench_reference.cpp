// Experiments with the path tracer: convergence towards it, and its own speed.
#include "editor/command_line/bench_runner.h"

#include "engine/simulation/path_movers.h"
#include "gi_module/reference/path_tracer.h"
#include "gi_module/reference/surface_distance.h"

#include <chrono>
#include <cmath>

namespace sunfleck::command_line {
namespace {

using namespace gi::reference;

constexpr Size convergence_size{64, 48};

// The path tracer's image of the scene, and the distance from each pixel to other surfaces.
struct Truth {
    Accumulation image;
    std::vector<float> distances;
};

Result<Truth> trace_truth(Bench& bench) {
    viewer::SceneRenderer& renderer = *bench.renderer;
    simulation::set_movers_to_step(renderer.registry(), 0);
    SUNFLECK_TRY(renderer.rays().update(renderer.registry(), renderer.meshes()));
    const Bounds bounds = viewer::scene_bounds(renderer.registry(), renderer.meshes());
    const PathTracer tracer(renderer.rays(), gi::collect_emitters(renderer.registry(), renderer.meshes(), bounds));
    ReferenceSettings settings;
    settings.width = convergence_size.width;
    settings.height = convergence_size.height;
    settings.view = ReferenceView::irradiance;
    Truth truth;
    tracer.accumulate(truth.image, bench.start, settings, 4096);
    truth.distances = surface_distances(renderer.rays(), bench.start, settings.width, settings.height);
    return truth;
}

// What converges: the samples as random walks leave them, where none is clamped; or the default ones, everywhere.
struct Convergence {
    const char* name;
    bool defaults;
};
const Convergence convergences[] = {{"walks, clear pixels", false}, {"default sampler, all pixels", true}};

gi::Settings convergence_settings(const Convergence& what, std::uint32_t lights, std::uint32_t seed) {
    gi::Settings settings = gi::Settings().all_light_by("brute_force");
    settings.lights = lights;
    settings.seed = seed;
    if (!what.defaults) {
        settings.candidates = 1;
        settings.direct_share = 0.5f;
    }
    settings.with("movers", "static").with("kernel_pixels", "4"); // tiles fit the image
    settings.shadow_map_resolution = 128;
    return settings;
}

// RMSE over the pixels that are farther than `clear` from other surfaces.
double rmse(const io::Picture& picture, const Truth& truth, float clear) {
    double squares = 0, values = 0;
    for (std::size_t i = 0; i < picture.pixels.size(); ++i)
        if (picture.pixels[i].w > 0 && truth.image.covered[i] && truth.distances[i] > clear)
            for (int c = 0; c < 3; ++c) {
                const double d =
                    double(picture.pixels[i][c]) - truth.image.sums[i * 3 + std::size_t(c)] / truth.image.samples;
                squares += d * d;
                values += 1;
            }
    return std::sqrt(squares / values);
}

// Errors of five seeds. Where `clear` is 0, it is set by this call and then stays the same, so that all counts of
// samples are compared over the same pixels; below 0, those are all.
Result<std::vector<double>> errors_of(Bench& bench, const Truth& truth, const Convergence& what, std::uint32_t lights,
                                      float& clear) {
    std::vector<double> errors;
    for (std::uint32_t seed = 1; seed <= 5; ++seed) {
        SUNFLECK_TRY(bench.measure(convergence_settings(what, lights, seed), 0, 1, false));
        SUNFLECK_ASSIGN(const io::Picture picture, bench.renderer->read_back());
        if (clear == 0.0f)
            clear = 1.0f / std::sqrt(bench.renderer->lighting().sample_set().geometry_bound());
        errors.push_back(rmse(picture, truth, clear));
        if (interrupted())
            return Error{"interrupted"};
    }
    return errors;
}

Result<PlotSeries> scene_convergence(Bench& bench, const Truth& truth, const Convergence& what,
                                     const std::string& scene, BenchTable& table) {
    float clear = what.defaults ? -1.0f : 0.0f;
    PlotSeries series{scene, {}};
    Progress progress("convergence " + scene + ", " + what.name);
    for (std::uint32_t lights = 256; lights <= 16384; lights *= 2) {
        SUNFLECK_ASSIGN(const std::vector<double> errors, errors_of(bench, truth, what, lights, clear));
        series.points.emplace_back(lights, median(errors));
        table.rows.push_back({{"scene", scene},
                              {"samples", what.name},
                              {"lights", lights},
                              {"rmse", median(errors)},
                              {"rmse_min", percentile(errors, 0)},
                              {"rmse_max", percentile(errors, 1)}});
        progress.show(std::log2(double(lights) / 128) / 7, std::to_string(lights) + " lights");
    }
    return series;
}

Status converge(const BenchOptions& options, const std::string& scene, BenchTable& table,
                std::vector<PlotSeries>& plot) {
    SUNFLECK_ASSIGN(const auto bench, Bench::create(options, scene, "view", convergence_size));
    bench->request.view = shared::view_irradiance;
    bench->request.tone_map = false;
    SUNFLECK_ASSIGN(const Truth truth, trace_truth(*bench));
    for (const Convergence& what : convergences) {
        SUNFLECK_ASSIGN(const PlotSeries series, scene_convergence(*bench, truth, what, scene, table));
        table.notes["slope_" + scene + (what.defaults ? "_default" : "")] = log_log_slope(series.points);
        if (!what.defaults)
            plot.push_back(series);
    }
    return {};
}

} // namespace

Result<BenchTable> bench_convergence(const BenchOptions& options, std::vector<PlotSeries>& plot) {
    BenchTable table{"convergence", {}, {}};
    for (const char* scene : {"cornell", "area_room", "four_pillars"})
        SUNFLECK_TRY(converge(options, scene, table, plot));
    return table;
}

namespace {

// Million rays per second of each of `repeat` measurements.
std::vector<double> ray_rates(const PathTracer& tracer, const scene::CameraView& camera, std::uint32_t repeat) {
    std::vector<double> rates;
    for (std::uint32_t i = 0; i < repeat; ++i) {
        Accumulation accumulation;
        ReferenceSettings settings;
        settings.width = 320;
        settings.height = 180;
        const auto began = std::chrono::steady_clock::now();
        tracer.accumulate(accumulation, camera, settings, 16);
        const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - began;
        rates.push_back(double(accumulation.rays) / elapsed.count() * 1e-6);
    }
    return rates;
}

} // namespace

Result<BenchTable> bench_reference(const BenchOptions& options) {
    BenchTable table{"reference", {}, {}};
    for (const char* scene : {"cornell", "four_pillars"}) {
        ecs::Registry registry;
        scene::MeshStore meshes;
        scene::TextureStore textures;
        SUNFLECK_ASSIGN(const std::filesystem::path path, find_scene(scene));
        SUNFLECK_ASSIGN(const io::ImportReport report, io::load_scene(path, registry, meshes, textures));
        SUNFLECK_ASSIGN(const auto rays, raytrace::RayScene::create());
        SUNFLECK_TRY(rays->update(registry, meshes));
        const Bounds bounds = viewer::scene_bounds(registry, meshes);
        SUNFLECK_ASSIGN(const scene::CameraView camera, viewer::find_camera(registry, bounds, "view"));
        const PathTracer tracer(*rays, gi::collect_emitters(registry, meshes, bounds));
        const std::vector<double> rates = ray_rates(tracer, camera, options.repeat);
        table.rows.push_back({{"scene", scene},
                              {"million_rays_per_second", median(rates)},
                              {"minimum", percentile(rates, 0)},
                              {"maximum", percentile(rates, 1)}});
    }
    return table;
}

} // namespace sunfleck::command_line

// sunfleck bench: named experiments. Times are medians over repeats; speed is read as a ratio within one run.
#include "editor/command_line/bench_runner.h"

#include "engine/core/file.h"
#include "engine/simulation/path_movers.h"
#include "gi_module/reference/path_tracer.h"
#include "gi_module/reference/surface_distance.h"

#include <chrono>
#include <cmath>

namespace sunfleck::command_line {
namespace {

// ns for each light and pixel of every shape that the kernel can take. Shapes take turns, so that a slow spell of the
// machine touches all alike.
Result<BenchTable> bench_kernel(const BenchOptions& options) {
    constexpr std::uint32_t lights = 256;
    constexpr Size size{640, 360};
    SUNFLECK_ASSIGN(const auto bench, Bench::create(options, "four_pillars", "bench_1", size));
    struct Candidate {
        gi::KernelShape shape;
        bool shadows;
        std::vector<double> ns;
    };
    std::vector<Candidate> candidates;
    for (const bool shadows : {false, true})
        for (const std::uint32_t pixels : {1u, 2u, 4u, 8u, 16u})
            for (const bool storage_lights : {false, true})
                for (const std::uint32_t maps : {shared::maps_texel_buffer, shared::maps_storage_buffer})
                    if (shadows || maps == shared::maps_texel_buffer)
                        candidates.push_back({{pixels, maps, storage_lights}, shadows, {}});
    const gi::KernelShape standard = gi::BruteForce::default_shape(bench->device->traits());
    const std::size_t shapes = candidates.size();
    for (const bool shadows : {false, true}) // what brute force itself uses, measured like the others
        candidates.push_back({standard, shadows, {}});
    gi::Settings settings = gi::Settings::brute_force();
    settings.lights = lights;
    Progress progress("bench kernel");
    for (std::uint32_t round = 0; round < options.repeat; ++round)
        for (std::size_t i = 0; i < candidates.size(); ++i) {
            Candidate& candidate = candidates[round % 2 == 0 ? i : candidates.size() - 1 - i];
            settings.shadows = candidate.shadows;
            bench->renderer->lighting().brute_force().set_shape(candidate.shape);
            SUNFLECK_ASSIGN(const Measurement measurement, bench->measure(settings, round == 0 ? 2 : 1, 1, false));
            candidate.ns.push_back(Bench::gpu_median(measurement, "brute force") * 1e6 /
                                   (double(lights) * size.width * size.height));
            if (interrupted())
                return Error{"interrupted"};
            progress.show(double(round * candidates.size() + i + 1) / double(options.repeat * candidates.size()), "");
        }
    BenchTable table{"kernel", {}, {}};
    double best[2] = {1e30, 1e30};
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        const Candidate& c = candidates[i];
        const double ns = median(c.ns);
        if (i < shapes)
            best[c.shadows] = std::min(best[c.shadows], ns);
        table.rows.push_back({{"shadowed", c.shadows ? "yes" : "no"},
                              {"pixels", c.shape.pixels},
                              {"lights", c.shape.storage_lights ? "storage" : "uniform"},
                              {"maps", !c.shadows                                  ? "-"
                                       : c.shape.maps == shared::maps_texel_buffer ? "texel"
                                                                                   : "storage"},
                              {"ns_per_light_pixel", ns},
                              {"spread_ns", percentile(c.ns, 0.75) - percentile(c.ns, 0.25)},
                              {"used", i >= shapes ? "brute force" : ""}});
    }
    table.notes["brute_force_over_best_unshadowed"] = median(candidates[shapes].ns) / best[0];
    table.notes["brute_force_over_best_shadowed"] = median(candidates[shapes + 1].ns) / best[1];
    return table;
}

// Whole frames and passes for 64, 300 and 1,024 samples at two sizes.
Result<BenchTable> bench_brute_force(const BenchOptions& options) {
    BenchTable table{"brute_force", {}, {}};
    const std::string scene = options.scene.empty() ? "four_pillars" : options.scene;
    for (const Size size : {Size{640, 360}, Size{1024, 768}}) {
        SUNFLECK_ASSIGN(const auto bench, Bench::create(options, scene, "bench_1", size));
        for (const std::uint32_t lights : {64u, 300u, 1024u}) {
            gi::Settings settings = gi::Settings::brute_force();
            settings.lights = lights;
            SUNFLECK_ASSIGN(const Measurement m, bench->measure(settings, 2, options.repeat, true));
            table.rows.push_back({{"size", std::to_string(size.width) + "x" + std::to_string(size.height)},
                                  {"lights", lights},
                                  {"frame_ms", median(m.frame_ms)},
                                  {"frame_ms_p95", percentile(m.frame_ms, 0.95)},
                                  {"brute_force_ms", Bench::gpu_median(m, "brute force")},
                                  {"shadow_maps_ms", Bench::gpu_median(m, "shadow maps")},
                                  {"map_copies_ms", Bench::gpu_median(m, "shadow map copies")},
                                  {"g_buffer_ms", Bench::gpu_median(m, "g-buffer")},
                                  {"composition_ms", Bench::gpu_median(m, "composition")},
                                  {"map_updates", m.counters.shadow_map_updates}});
            if (interrupted())
                return Error{"interrupted"};
        }
    }
    return table;
}

// Microseconds a map and a thousand vertices.
Result<BenchTable> bench_shadow_maps(const BenchOptions& options) {
    BenchTable table{"shadow_maps", {}, {}};
    for (const char* scene : {"cornell", "table_room", "four_pillars"})
        for (const std::uint32_t resolution : {128u, 256u, 512u}) {
            SUNFLECK_ASSIGN(const auto bench, Bench::create(options, scene, "bench_1", {64, 36}));
            gi::Settings settings = gi::Settings::brute_force();
            settings.lights = 256;
            settings.shadow_map_resolution = resolution;
            std::vector<double> draw, copy;
            gi::Counters counters;
            for (std::uint32_t i = 0; i <= options.repeat; ++i) {
                settings.seed = i + 1; // new samples: every map is drawn
                SUNFLECK_ASSIGN(const Measurement m, bench->measure(settings, 0, 1, false));
                if (i == 0)
                    continue;
                draw.push_back(Bench::gpu_median(m, "shadow maps"));
                copy.push_back(Bench::gpu_median(m, "shadow map copies"));
                counters = m.counters;
            }
            const double maps = double(counters.shadow_map_updates);
            table.rows.push_back({{"scene", scene},
                                  {"resolution", resolution},
                                  {"maps", counters.shadow_map_updates},
                                  {"faces", counters.shadow_map_faces},
                                  {"vertices_per_map", double(counters.shadow_map_vertices) / maps},
                                  {"us_per_map", median(draw) * 1e3 / maps},
                                  {"us_copy_per_map", median(copy) * 1e3 / maps},
                                  {"us_per_1000_vertices", median(draw) * 1e6 / double(counters.shadow_map_vertices)}});
        }
    return table;
}

// Error against the reference over the number of samples, five seeds each, over the pixels that are farther from other
// surfaces than 1/sqrt(G_max) at the smallest count.
Result<BenchTable> bench_convergence(const BenchOptions& options, std::vector<PlotSeries>& plot) {
    using namespace gi::reference;
    constexpr Size size{64, 48};
    BenchTable table{"convergence", {}, {}};
    for (const char* scene : {"cornell", "area_room", "four_pillars"}) {
        SUNFLECK_ASSIGN(const auto bench, Bench::create(options, scene, "view", size));
        bench->request.view = shared::view_irradiance;
        bench->request.tone_map = false;
        viewer::SceneRenderer& renderer = *bench->renderer;
        simulation::set_movers_to_step(renderer.registry(), 0);
        SUNFLECK_TRY(renderer.rays().update(renderer.registry(), renderer.meshes()));
        const Bounds bounds = viewer::scene_bounds(renderer.registry(), renderer.meshes());
        const PathTracer tracer(renderer.rays(), gi::collect_emitters(renderer.registry(), renderer.meshes(), bounds));
        ReferenceSettings reference;
        reference.width = size.width;
        reference.height = size.height;
        reference.view = ReferenceView::irradiance;
        Accumulation truth;
        tracer.accumulate(truth, bench->start, reference, 4096);
        const std::vector<float> distances = surface_distances(renderer.rays(), bench->start, size.width, size.height);
        float clear = 0.0f; // pixels nearer to other surfaces than this are left out, at every count alike
        renderer.lighting().brute_force().set_shape({4, shared::maps_texel_buffer, false}); // tiles fit the picture
        PlotSeries series{scene, {}};
        Progress progress(std::string("convergence ") + scene);
        for (std::uint32_t lights = 256; lights <= 16384; lights *= 2) {
            std::vector<double> errors;
            for (std::uint32_t seed = 1; seed <= 5; ++seed) {
                gi::Settings settings = gi::Settings::brute_force();
                settings.candidates = 1; // as walks leave them
                settings.lights = lights;
                settings.direct_share = 0.5f;
                settings.seed = seed;
                settings.movers = gi::MoverHandling::as_static;
                settings.shadow_map_resolution = 128;
                SUNFLECK_ASSIGN(const Measurement m, bench->measure(settings, 0, 1, false));
                SUNFLECK_ASSIGN(const io::Picture picture, renderer.read_back());
                if (clear == 0.0f)
                    clear = 1.0f / std::sqrt(renderer.lighting().geometry_bound());
                double squares = 0, values = 0;
                for (std::size_t i = 0; i < picture.pixels.size(); ++i)
                    if (picture.pixels[i].w > 0 && truth.covered[i] && distances[i] > clear)
                        for (int c = 0; c < 3; ++c) {
                            const double d =
                                double(picture.pixels[i][c]) - truth.sums[i * 3 + std::size_t(c)] / truth.samples;
                            squares += d * d;
                            values += 1;
                        }
                errors.push_back(std::sqrt(squares / values));
                if (interrupted())
                    return Error{"interrupted"};
            }
            series.points.emplace_back(lights, median(errors));
            table.rows.push_back({{"scene", scene},
                                  {"lights", lights},
                                  {"rmse", median(errors)},
                                  {"rmse_min", percentile(errors, 0)},
                                  {"rmse_max", percentile(errors, 1)}});
            progress.show(std::log2(double(lights) / 128) / 7, std::to_string(lights) + " lights");
        }
        table.notes[std::string("slope_") + scene] = log_log_slope(series.points);
        plot.push_back(series);
    }
    return table;
}

Result<BenchTable> bench_reference(const BenchOptions& options) {
    using namespace gi::reference;
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
        std::vector<double> rates;
        for (std::uint32_t i = 0; i < options.repeat; ++i) {
            Accumulation accumulation;
            ReferenceSettings settings;
            settings.width = 320;
            settings.height = 180;
            const auto began = std::chrono::steady_clock::now();
            tracer.accumulate(accumulation, camera, settings, 16);
            const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - began;
            rates.push_back(double(accumulation.rays) / elapsed.count() * 1e-6);
        }
        table.rows.push_back({{"scene", scene},
                              {"million_rays_per_second", median(rates)},
                              {"minimum", percentile(rates, 0)},
                              {"maximum", percentile(rates, 1)}});
    }
    return table;
}

} // namespace

Status bench(const BenchOptions& options) {
    std::vector<PlotSeries> plot;
    const auto start = [&]() -> Result<BenchTable> {
        if (options.suite == "kernel")
            return bench_kernel(options);
        if (options.suite == "brute_force")
            return bench_brute_force(options);
        if (options.suite == "shadow_maps")
            return bench_shadow_maps(options);
        if (options.suite == "convergence")
            return bench_convergence(options, plot);
        if (options.suite == "thesis")
            return bench_thesis(options, plot);
        return bench_reference(options);
    };
    if (!options.part.empty() && options.suite != "thesis")
        return Error{"--part: only the suite 'thesis' has parts"};
    SUNFLECK_ASSIGN(const BenchTable table, start());
    SUNFLECK_ASSIGN(const auto device, gpu::Device::create({options.device, false, {}}));
    if (options.as_json)
        std::printf("%s\n", table.json(device.get()).dump(2).c_str());
    else
        table.print();
    if (!options.csv.empty())
        SUNFLECK_TRY(write_file(options.csv, table.csv()));
    if (!options.plot.empty()) {
        if (plot.empty())
            return Error{"--plot: the suite '" + options.suite + "' has no plot (convergence and thesis have)"};
        const bool thesis = options.suite == "thesis";
        SUNFLECK_TRY(write_file(
            options.plot,
            plot_svg(thesis ? "Frame time, 1024x768" : "Error against the path tracer, brute force, five seeds",
                     "light samples", thesis ? "ms a frame" : "RMSE of irradiance, W/m2", plot)));
    }
    return {};
}

} // namespace sunfleck::command_line

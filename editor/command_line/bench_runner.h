// Common parts of the experiments: options, and a loaded scene that is measured under given settings.
#pragma once

#include "editor/command_line/bench_table.h"

namespace sunfleck::command_line {

struct BenchOptions {
    std::string suite, csv, plot, device, scene;
    std::string part; // of the suite thesis; empty: all
    bool as_json = false;
    std::uint32_t repeat = 5;
};

// A loaded scene, ready to be measured.
struct Bench {
    static Result<std::unique_ptr<Bench>> create(const BenchOptions& options, const std::string& scene,
                                                 const std::string& camera, Size size) {
        auto bench = std::make_unique<Bench>();
        SUNFLECK_ASSIGN(bench->device, gpu::Device::create({options.device, false, {}}));
        SUNFLECK_ASSIGN(bench->renderer, viewer::SceneRenderer::create(*bench->device));
        SUNFLECK_ASSIGN(const std::filesystem::path path, find_scene(scene));
        SUNFLECK_ASSIGN(const io::ImportReport report, bench->renderer->load(path));
        const Bounds bounds = viewer::scene_bounds(bench->renderer->registry(), bench->renderer->meshes());
        SUNFLECK_ASSIGN(bench->request.camera, viewer::find_camera(bench->renderer->registry(), bounds, camera));
        bench->start = bench->request.camera;
        bench->request.width = size.width;
        bench->request.height = size.height;
        bench->request.ev100 = viewer::scene_exposure(bench->renderer->registry());
        return bench;
    }
    // Renders `warmup` frames, then measures `frames` frames while movers and camera move. The first measured frame has
    // the camera at its initial position, however long the warm-up.
    Result<Measurement> measure(const gi::Settings& settings, std::uint32_t warmup, std::uint32_t frames, bool motion) {
        SUNFLECK_TRY(renderer->lighting().set_settings(settings));
        Measurement measurement;
        for (std::uint32_t i = 0; i < warmup + frames; ++i) {
            request.camera = start.orbited(glm::radians(0.25f) * (float(i) - float(warmup)));
            request.step = motion ? step++ : 0;
            SUNFLECK_TRY(renderer->render_and_wait(request));
            if (i < warmup)
                continue;
            const viewer::FrameStatistics& statistics = renderer->statistics();
            measurement.frame_ms.push_back(statistics.frame_ms);
            measurement.cpu_ms.push_back(statistics.cpu_ms);
            measurement.gpu_ms.push_back(statistics.gpu_ms);
            measurement.counters = statistics.counters;
        }
        return measurement;
    }
    static double gpu_median(const Measurement& measurement, const std::string& pass) {
        std::vector<double> values;
        for (const auto& frame : measurement.gpu_ms)
            if (const auto found = frame.find(pass); found != frame.end())
                values.push_back(found->second);
        return median(values);
    }

    std::unique_ptr<gpu::Device> device;
    std::unique_ptr<viewer::SceneRenderer> renderer;
    viewer::FrameRequest request;
    scene::CameraView start;
    std::uint64_t step = 0;
};

// ns per light and pixel of every shape of the kernel.
Result<BenchTable> bench_kernel(const BenchOptions& options);
// Frames and passes for 64, 300 and 1,024 samples at two sizes.
Result<BenchTable> bench_brute_force(const BenchOptions& options);
// Microseconds per map and per thousand vertices.
Result<BenchTable> bench_shadow_maps(const BenchOptions& options);
// RMSE against the path tracer by number of samples, five seeds each, over the pixels that are farther from other
// surfaces than 1/sqrt(G_max) at the smallest number.
Result<BenchTable> bench_convergence(const BenchOptions& options, std::vector<PlotSeries>& plot);
// Speed of the path tracer.
Result<BenchTable> bench_reference(const BenchOptions& options);
// The experiments of chapter 5 of the thesis and of its fig. 4-11 and 4-12.
Result<BenchTable> bench_thesis(const BenchOptions& options, std::vector<PlotSeries>& plot);
// Their names, for BenchOptions::part.
std::vector<std::string> thesis_parts();

} // namespace sunfleck::command_line

// What experiments share: a scene that renders frame after frame under given settings.
#pragma once

#include "editor/command_line/bench_table.h"
#include "editor/command_line/commands.h"

namespace sunfleck::command_line {

// A scene loaded and ready to render frame after frame.
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
    // Renders `warmup` frames unmeasured, then `frames` measured ones; movers and camera move on. Measured frames begin
    // at the camera's own place, however long the warm-up.
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

// The experiments of the thesis's chapter 5 (and fig. 4-11, 4-12), see bench_thesis.cpp.
Result<BenchTable> bench_thesis(const BenchOptions& options, std::vector<PlotSeries>& plot);

} // namespace sunfleck::command_line

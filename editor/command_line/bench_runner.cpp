#include "editor/command_line/bench_runner.h"
#include "viewer/exposure.h"

namespace sunfleck::command_line {

Result<std::unique_ptr<Bench>> Bench::create(const BenchOptions& options, const std::string& scene,
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
    bench->request.ev100 = viewer::scene_exposure(bench->renderer->registry()).value_or(viewer::default_exposure);
    return bench;
}

Result<Measurement> Bench::measure(const gi::Settings& settings, std::uint32_t warmup, std::uint32_t frames,
                                   bool motion) {
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

double Bench::gpu_median(const Measurement& measurement, const std::string& pass) {
    std::vector<double> values;
    for (const auto& frame : measurement.gpu_ms)
        if (const auto found = frame.find(pass); found != frame.end())
            values.push_back(found->second);
    return median(values);
}

} // namespace sunfleck::command_line

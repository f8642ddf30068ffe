// What the experiments share: a loaded scene that is measured under given settings.
#pragma once

#include "editor/command_line/bench_table.h"
#include "editor/command_line/commands.h"

namespace sunfleck::command_line {

// A loaded scene, ready to be measured.
struct Bench {
    static Result<std::unique_ptr<Bench>> create(const BenchOptions& options, const std::string& scene,
                                                 const std::string& camera, Size size);
    // Renders `warmup` frames, then measures `frames` frames while movers and camera move. The first measured frame has
    // the camera at its initial position, however long the warm-up.
    Result<Measurement> measure(const gi::Settings& settings, std::uint32_t warmup, std::uint32_t frames, bool motion);
    static double gpu_median(const Measurement& measurement, const std::string& pass);

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
// Edges, stains, crawl and FLIP of the quality presets' displayed pictures.
Result<BenchTable> bench_picture(const BenchOptions& options);
// The experiments of chapter 5 of the thesis and of its fig. 4-11 and 4-12.
Result<BenchTable> bench_thesis(const BenchOptions& options, std::vector<PlotSeries>& plot);

// The experiments of the paper on splatting, its figures beside ours.
Result<BenchTable> bench_splatting(const BenchOptions& options);

} // namespace sunfleck::command_line

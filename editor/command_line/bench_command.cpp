// sunfleck bench: named experiments. Times are medians over repeats; compare speeds only as ratios within one run.
#include "editor/command_line/bench_runner.h"

#include "engine/core/file.h"

namespace sunfleck::command_line {
namespace {

Result<BenchTable> run_suite(const BenchOptions& options, std::vector<PlotSeries>& plot) {
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
}

Status write_plot(const BenchOptions& options, const std::vector<PlotSeries>& plot) {
    if (plot.empty())
        return Error{"--plot: the suite '" + options.suite + "' has no plot (only convergence and thesis have)"};
    const bool thesis = options.suite == "thesis";
    const char* title = thesis ? "Frame time, 1024x768" : "Error against the path tracer, brute force, five seeds";
    const char* unit = thesis ? "ms per frame" : "RMSE of irradiance, W/m2";
    return write_file(options.plot, plot_svg(title, "light samples", unit, plot));
}

Status run(const BenchOptions& options) {
    if (!options.part.empty() && options.suite != "thesis")
        return Error{"--part: only the suite 'thesis' has parts"};
    std::vector<PlotSeries> plot;
    SUNFLECK_ASSIGN(const BenchTable table, run_suite(options, plot));
    SUNFLECK_ASSIGN(const auto device, gpu::Device::create({options.device, false, {}}));
    if (options.as_json)
        std::printf("%s\n", table.json(device.get()).dump(2).c_str());
    else
        table.print();
    if (!options.csv.empty())
        SUNFLECK_TRY(write_file(options.csv, table.csv()));
    return options.plot.empty() ? Status() : write_plot(options, plot);
}

} // namespace

Command make_bench_command(CLI::App& program) {
    auto options = std::make_shared<BenchOptions>();
    CLI::App* app = program.add_subcommand("bench", "Runs a named experiment and prints its table");
    app->footer("Example: sunfleck bench kernel --repeat 9 --csv kernel.csv\n"
                "kernel       ns per light and pixel of every kernel shape, with and without shadows\n"
                "brute_force  frame and pass times for 64, 300 and 1,024 samples at 640x360 and 1024x768\n"
                "shadow_maps  microseconds per map and per thousand vertices\n"
                "convergence  error against the path tracer by number of samples (--plot)\n"
                "reference    rays per second of the path tracer\n"
                "thesis       frame times, ablation, map updates, passes and quality, as in chapter 5 of the thesis\n"
                "             (--part movers runs only one of its experiments)");
    app->add_option("SUITE", options->suite, "Name of the experiment")
        ->required()
        ->check(CLI::IsMember({"kernel", "brute_force", "shadow_maps", "convergence", "reference", "thesis"}));
    app->add_flag("--json", options->as_json, "Print a JSON object");
    app->add_option("--csv", options->csv, "Write the rows as CSV");
    app->add_option("--plot", options->plot, "Write a plot as SVG");
    app->add_option("--repeat", options->repeat, "Measurements per row")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    app->add_option("--scene", options->scene, "Scene, for suites that take one");
    app->add_option("--part", options->part, "Run only this experiment of the suite thesis")
        ->check(CLI::IsMember(thesis_parts()));
    app->add_option("--device", options->device, "Vulkan device, by index or part of its name");
    return {app, [options] {
                watch_interrupts();
                const Status status = run(*options);
                return status ? 0 : fail(status.error());
            }};
}

} // namespace sunfleck::command_line

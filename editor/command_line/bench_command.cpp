// sunfleck bench: named experiments. Times are medians over repeats; compare speeds only as ratios within one run.
#include "editor/command_line/thesis_experiments.h"

#include "engine/core/file.h"
#include "engine/core/output.h"

#include <algorithm>
#include <cstdio>

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
    if (options.suite == "picture")
        return bench_picture(options);
    if (options.suite == "thesis")
        return bench_thesis(options, plot);
    if (options.suite == "splatting")
        return bench_splatting(options);
    return bench_reference(options);
}

// Techniques can be left out of a build.
Status check_techniques(const std::string& suite) {
    std::vector<std::string_view> needed;
    if (suite != "reference" && suite != "splatting")
        needed.push_back("brute_force");
    if (suite == "thesis" || suite == "picture")
        needed.push_back("light_samples");
    if (suite == "splatting")
        needed.push_back("splatting");
    const auto there = gi::techniques();
    for (const std::string_view name : needed)
        if (std::none_of(there.begin(), there.end(), [&](const auto& entry) { return entry.name == name; }))
            return Error{"the suite '" + suite + "' measures the technique '" + std::string(name) +
                         "', which this build does not have"};
    return {};
}

// The thesis's experiments have scenes of their own; of those that take times in all of them, one scene may be chosen.
Status check_scene(const BenchOptions& options) {
    const bool times = options.part == "ratios" || options.part == "first_frames";
    if (options.suite == "thesis" && !times)
        return Error{"--scene: of the suite 'thesis' only the parts ratios and first_frames take one"};
    if (options.suite == "thesis" && thesis_cameras.count(options.scene) == 0)
        return Error{"--scene: '" + options.scene +
                     "' is none of the thesis's scenes (area_room, table_room, four_pillars)"};
    if (options.suite == "brute_force" || options.suite == "shadow_maps" || options.suite == "reference" ||
        options.suite == "splatting")
        return Error{"--scene: the suite '" + options.suite +
                     "' has scenes of its own (only kernel, convergence, picture and thesis take one)"};
    SUNFLECK_TRY(find_scene(options.scene));
    return {};
}

Status check_part(const BenchOptions& options) {
    const std::vector<std::string> parts = options.suite == "thesis"      ? thesis_parts()
                                           : options.suite == "picture"   ? picture_parts()
                                           : options.suite == "splatting" ? splatting_parts()
                                                                          : std::vector<std::string>();
    if (!options.part.empty() && std::find(parts.begin(), parts.end(), options.part) == parts.end())
        return Error{"--part: the suite '" + options.suite + "' has no part '" + options.part +
                     "' (only thesis, picture and splatting have parts)"};
    return {};
}

Status write_plot(const BenchOptions& options, const std::vector<PlotSeries>& plot) {
    if (plot.empty())
        return Error{"--plot: this part of the suite '" + options.suite + "' has no plot"};
    const bool thesis = options.suite == "thesis";
    const char* title = thesis ? "Frame time, 1024x768" : "Error against the path tracer, brute force, five seeds";
    const char* unit = thesis ? "ms per frame" : "RMSE of irradiance, W/m2";
    return write_file(options.plot, plot_svg(title, "light samples", unit, plot));
}

} // namespace

Status bench(const BenchOptions& options) {
    SUNFLECK_TRY(check_techniques(options.suite));
    SUNFLECK_TRY(check_part(options));
    if (!options.folder.empty() && options.suite != "picture")
        return Error{"--folder: only the suite 'picture' keeps its work"};
    if (!options.scene.empty())
        SUNFLECK_TRY(check_scene(options));
    if (!options.plot.empty() && options.suite != "convergence" && options.suite != "thesis")
        return Error{"--plot: the suite '" + options.suite + "' has no plot (only convergence and thesis have)"};
    const NamedFile outputs[] = {{"--csv", options.csv}, {"--plot", options.plot}};
    SUNFLECK_TRY(try_outputs(outputs));
    // One that is not there is named before anything is measured.
    if (!options.device.empty())
        if (const auto named = gpu::Device::create({options.device, false, {}}); !named)
            return named.error();
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

} // namespace sunfleck::command_line

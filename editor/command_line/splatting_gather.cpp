// Splatted light beside gathered light, at equal error: pixels that look up texels of reflective shadow maps (C.
// Dachsbacher and M. Stamminger, "Reflective Shadow Maps", I3D 2005), and a gather of the splatted lights by all
// pixels.
#include "editor/command_line/metrics.h"
#include "editor/command_line/splatting_experiments.h"

#include <array>
#include <cmath>
#include <optional>
#include <span>

namespace sunfleck::command_line {
namespace {

constexpr const char* gather_rays = "16384";
constexpr std::uint32_t gather_warmup = 4, frames_a_turn = 4;

struct Gather {
    const char* name;
    bool splatted;
    bool on; // of splatted light: lists for groups of pixels; of gathered light: softening
    std::uint32_t low_resolution;
    std::array<std::uint32_t, 5> counts;
};
// The paper's picture has 512 x 512 pixels and a grid of 64 x 64.
constexpr Gather gathers[] = {{"splatted, tile lists", true, true, 4, {64, 128, 256, 512, 1024}},
                              {"plain gather of the same lights", true, false, 4, {64, 128, 256, 512, 1024}},
                              {"rsm_gather, every 4th pixel", false, false, 4, {64, 256, 512, 1024, 4096}},
                              {"rsm_gather, every 4th pixel, softened", false, true, 4, {64, 256, 512, 1024, 4096}},
                              {"rsm_gather, every 8th pixel", false, false, 8, {64, 256, 512, 1024, 4096}},
                              {"rsm_gather, every pixel", false, false, 1, {64, 128, 256, 512, 1024}}};

// Only another seed chooses all lights afresh: those that are followed keep their places.
std::uint32_t gather_seed(std::size_t count, std::uint32_t seed, std::uint32_t seeds) {
    return std::uint32_t(count) * seeds + seed;
}

gi::Settings gather_settings(const Gather& gather, std::uint32_t count, std::uint32_t seed) {
    gi::Settings settings = splats_alone(count, "none");
    settings.seed = seed;
    settings.low_resolution = gather.low_resolution;
    if (gather.splatted)
        return settings.with("splat_rays", gather_rays)
            .with("splat_importance", "contribution")
            .with("splat_lists", gather.on ? "on" : "off");
    settings.with("splat_lights", "none").with("gather_lights", "all").with("gather_rays", gather_rays);
    return settings.with("gather_samples", std::to_string(count)).with("gather_softening", gather.on ? "on" : "off");
}

// Lists, light, reconstruction and repair.
double gather_passes_ms(const Measurement& measurement) {
    return passes_ms(measurement, {"splat", "gathered light", "places of gathered light", "repair", "low-resolution",
                                   "light resolve", "reconstruction", "compaction", "shadow maps of pixel"});
}

// The same with maps and choice of lights.
double gather_ms(const Measurement& measurement) {
    return stage_ms(measurement, "pixel lights") + stage_ms(measurement, "gathered maps") +
           gather_passes_ms(measurement);
}

struct GatherPoint {
    double error = 0.0;
    std::vector<double> times, passes; // ms, by turn: with maps and choice of lights on the CPU, and without
};
using GatherCurve = std::array<GatherPoint, 5>;

// The times at which a curve has an error, on a line through the two points beside it in logarithms. None: it lies
// beyond the curve's ends.
std::optional<double> time_at(const GatherCurve& curve, double error, std::vector<double> GatherPoint::*times) {
    for (std::size_t i = 0; i + 1 < curve.size(); ++i) {
        const double from = std::log(curve[i].error), to = std::log(curve[i + 1].error), at = std::log(error);
        if ((at > from) == (at > to) || from == to)
            continue;
        const double share = (at - from) / (to - from);
        return std::exp((1.0 - share) * std::log(median(curve[i].*times)) +
                        share * std::log(median(curve[i + 1].*times)));
    }
    return std::nullopt;
}

Status find_errors(SplatExperiment& experiment, Bench& bench, std::span<GatherCurve> curves) {
    SUNFLECK_TRY(bench.renderer->lighting().set_settings(splat_limit("none")));
    SUNFLECK_ASSIGN(const io::Picture limit, splat_picture(bench, 0));
    for (std::size_t g = 0; g < curves.size(); ++g)
        for (std::size_t i = 0; i < curves[g].size(); ++i)
            for (std::uint32_t seed = 1; seed <= experiment.options.repeat; ++seed) {
                SUNFLECK_TRY(bench.renderer->lighting().set_settings(gather_settings(
                    gathers[g], gathers[g].counts[i], gather_seed(i, seed, experiment.options.repeat))));
                SUNFLECK_ASSIGN(const io::Picture picture, splat_picture(bench, 0));
                curves[g][i].error += compare_pictures(picture, limit, true).relative_mean_square_error /
                                      double(experiment.options.repeat);
            }
    return {};
}

// In turns, there and back.
Status find_times(SplatExperiment& experiment, Bench& bench, std::span<GatherCurve> curves) {
    const std::size_t all = curves.size() * curves[0].size();
    for (std::uint32_t turn = 0; turn < 2 * experiment.options.repeat; ++turn)
        for (std::size_t k = 0; k < all; ++k) {
            const std::size_t at = turn % 2 == 0 ? k : all - 1 - k, g = at % curves.size(), i = at / curves.size();
            // Another seed each, so that no lights are followed from the count before.
            SUNFLECK_ASSIGN(const Measurement m,
                            bench.measure(gather_settings(gathers[g], gathers[g].counts[i], std::uint32_t(k) + 1),
                                          gather_warmup, frames_a_turn, true));
            curves[g][i].times.push_back(gather_ms(m));
            curves[g][i].passes.push_back(gather_passes_ms(m));
        }
    return {};
}

// Of splatted light over the other's at the error of one of its counts; of the same lights, at the same count.
void add_ratios(SplatExperiment& experiment, const GatherCurve& splatted, std::size_t count, const GatherCurve& other,
                const Gather& gather) {
    for (const auto& [name, times] :
         {std::pair("all", &GatherPoint::times), std::pair("passes", &GatherPoint::passes)}) {
        const double ours = median(splatted[count].*times);
        const std::optional<double> theirs =
            gather.splatted ? median(other[count].*times) : time_at(other, splatted[count].error, times);
        char what[64];
        std::snprintf(what, sizeof what, "E of %u lights (%.2g), %s", gathers[0].counts[count], splatted[count].error,
                      name);
        if (theirs)
            experiment.row("arena", what, std::string("time over that of ") + gather.name, ours / *theirs,
                           gather.splatted ? "target: at most 1/2" : "target: at most 1/3");
    }
}

} // namespace

Status splat_gather(SplatExperiment& experiment) {
    if (gi::Settings::find("gather_lights") == nullptr)
        return Error{"the part 'gather' measures the technique 'rsm_gather', which this build does not have"};
    std::array<GatherCurve, std::size(gathers)> curves{};
    SUNFLECK_ASSIGN(const auto bench, open_splat_scene(experiment.options, "arena", splat_time_size));
    SUNFLECK_TRY(find_errors(experiment, *bench, curves));
    bench->request.view = shared::view_final;
    bench->request.tone_map = true;
    SUNFLECK_TRY(find_times(experiment, *bench, curves));
    for (std::size_t g = 0; g < curves.size(); ++g)
        for (std::size_t i = 0; i < curves[g].size(); ++i) {
            const std::string what = std::string(gathers[g].name) + ", " + std::to_string(gathers[g].counts[i]);
            experiment.row("arena", what, "E", curves[g][i].error);
            experiment.row("arena", what, "all, ms", median(curves[g][i].times));
            experiment.row("arena", what, "passes, ms", median(curves[g][i].passes));
        }
    for (std::size_t g = 1; g < curves.size(); ++g)
        for (std::size_t i = 0; i < curves[0].size(); ++i)
            add_ratios(experiment, curves[0], i, curves[g], gathers[g]);
    return {};
}

} // namespace sunfleck::command_line

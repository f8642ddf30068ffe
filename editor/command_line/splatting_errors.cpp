// Errors of splatted light against its limit: by number of lights and choice of their places, and from frame to frame.
#include "editor/command_line/flicker_meter.h"
#include "editor/command_line/metrics.h"
#include "editor/command_line/splatting_experiments.h"

namespace sunfleck::command_line {
namespace {

// The lamp's way lies between two of the piers, through whose corners it goes elsewhere.
constexpr std::uint32_t flicker_steps = 120, flicker_start = 180;

struct Way {
    const char* name;
    const char* pattern;
    const char* importance;
};
constexpr Way ways[] = {{"fixed, uniform", "fixed", "none"},
                        {"fixed, warped by flux", "fixed", "flux"},
                        {"followed, by flux", "followed", "flux"},
                        {"fixed, warped by contribution", "fixed", "contribution"},
                        {"followed, by contribution", "followed", "contribution"}};

gi::Settings settings_of(const Way& way, std::uint32_t count, std::uint32_t seed) {
    gi::Settings settings = splats_alone(count, "none");
    settings.seed = seed;
    settings.with("splat_rays", "16384");
    return settings.with("splat_pattern", way.pattern).with("splat_importance", way.importance);
}

Result<io::Picture> picture_with(Bench& bench, const gi::Settings& settings, std::uint64_t step, float orbit = 0.0f) {
    SUNFLECK_TRY(bench.renderer->lighting().set_settings(settings));
    return splat_picture(bench, step, orbit);
}

Result<double> error_of(Bench& bench, const Way& way, std::uint32_t count, const io::Picture& limit,
                        std::uint32_t seeds) {
    double sum = 0.0;
    for (std::uint32_t seed = 1; seed <= seeds; ++seed) {
        SUNFLECK_ASSIGN(const io::Picture picture, picture_with(bench, settings_of(way, count, seed), 0));
        sum += compare_pictures(picture, limit, true).relative_mean_square_error;
    }
    return sum / seeds;
}

} // namespace

Status splat_errors(SplatExperiment& experiment) {
    for (const char* scene : {"cornell", "arena"}) {
        SUNFLECK_ASSIGN(const auto bench, open_splat_scene(experiment.options, scene, splat_picture_size));
        SUNFLECK_ASSIGN(const io::Picture limit, picture_with(*bench, splat_limit("none"), 0));
        for (const Way& way : ways) {
            std::vector<std::pair<double, double>> points;
            for (const std::uint32_t count : {64u, 256u, 1024u, 4096u}) {
                SUNFLECK_ASSIGN(const double error, error_of(*bench, way, count, limit, experiment.options.repeat));
                experiment.row(scene, way.name, "E of " + std::to_string(count), error);
                points.emplace_back(double(count), error);
            }
            experiment.row(scene, way.name, "log-log slope", log_log_slope(points), "target: at most -0.8");
        }
    }
    return {};
}

namespace {

struct Motion {
    const char* name;
    bool lamp;
    float orbit; // degrees a step
    const char* note;
};

Status flicker_of(SplatExperiment& experiment, Bench& bench, const Motion& motion,
                  const std::vector<io::Picture>& limits, const Way& way) {
    FlickerMeter meter;
    SUNFLECK_TRY(bench.renderer->lighting().set_settings(settings_of(way, 1024, 1)));
    for (std::uint32_t i = 0; i < limits.size(); ++i) {
        SUNFLECK_ASSIGN(const io::Picture picture,
                        splat_picture(bench, flicker_start + (motion.lamp ? i : 0), motion.orbit * float(i)));
        meter.add(picture, limits[i]);
    }
    const std::string what = std::string(motion.name) + ", " + way.name;
    experiment.row("arena", what, "D", meter.change());
    experiment.row("arena", what, "F", meter.flicker(), motion.note);
    experiment.row("arena", what, "E", meter.error(), "target: at most 1.25 times the fixed, uniform pattern's");
    return {};
}

} // namespace

Status splat_flicker(SplatExperiment& experiment) {
    SUNFLECK_ASSIGN(const auto bench, open_splat_scene(experiment.options, "arena", splat_flicker_size));
    for (const Motion& motion :
         {Motion{"lamp", true, 0.0f, "target: at most 0.01"}, Motion{"camera", false, 0.25f, "target: at most 0.02"}}) {
        SUNFLECK_TRY(bench->renderer->lighting().set_settings(splat_limit("none")));
        std::vector<io::Picture> limits;
        for (std::uint32_t i = 0; i <= flicker_steps; ++i) {
            SUNFLECK_ASSIGN(io::Picture limit,
                            splat_picture(*bench, flicker_start + (motion.lamp ? i : 0), motion.orbit * float(i)));
            limits.push_back(std::move(limit));
        }
        for (const Way& way : ways)
            SUNFLECK_TRY(flicker_of(experiment, *bench, motion, limits, way));
        // How much a limit of a quarter of the texels changes says what in all of these is the limit's own.
        gi::Settings other = splat_limit("none").with("splats", "16384").with("splat_rays", "16384");
        SUNFLECK_TRY(bench->renderer->lighting().set_settings(other));
        FlickerMeter own;
        for (std::uint32_t i = 0; i < limits.size(); ++i) {
            SUNFLECK_ASSIGN(const io::Picture picture,
                            splat_picture(*bench, flicker_start + (motion.lamp ? i : 0), motion.orbit * float(i)));
            own.add(picture, limits[i]);
        }
        experiment.row("arena", std::string(motion.name) + ", limit of 16,384 texels", "D", own.change());
    }
    return {};
}

} // namespace sunfleck::command_line

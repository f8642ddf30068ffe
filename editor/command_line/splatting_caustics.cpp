// Caustics by glossy pixel lights: how their places and their shapes change the error.
#include "editor/command_line/metrics.h"
#include "editor/command_line/splatting_experiments.h"

namespace sunfleck::command_line {
namespace {

struct CausticWay {
    const char* name;
    const char* importance;
    const char* footprints;
};
constexpr CausticWay caustic_ways[] = {{"uniform, eq. 3", "none", "off"},
                                       {"flux x exponent, eq. 3", "flux", "off"},
                                       {"flux x exponent, beams", "flux", "on"}};

gi::Settings lobes(const CausticWay& way, const char* count) {
    gi::Settings settings = splats_alone(0, "maps").with("splat_rays", "65536").with("glossy_splats", count);
    return settings.with("splat_importance", way.importance).with("splat_footprints", way.footprints);
}

// Only where there is more light than in the mean: the caustic.
void leave_caustic(io::Picture& picture) {
    double mean = 0.0, lit = 0.0;
    for (const vec4& pixel : picture.pixels) {
        mean += pixel.w > 0.0f ? double(luminance(vec3(pixel))) : 0.0;
        lit += pixel.w > 0.0f ? 1.0 : 0.0;
    }
    for (vec4& pixel : picture.pixels)
        if (double(luminance(vec3(pixel))) * lit <= mean)
            pixel.w = 0.0f;
}

double energy(const io::Picture& picture, const io::Picture& where) {
    double sum = 0.0;
    for (std::size_t i = 0; i < picture.pixels.size(); ++i)
        sum += where.pixels[i].w > 0.0f ? double(luminance(vec3(picture.pixels[i]))) : 0.0;
    return sum;
}

} // namespace

Status splat_caustics(SplatExperiment& experiment) {
    SUNFLECK_ASSIGN(const auto bench, open_splat_scene(experiment.options, "ring", splat_picture_size));
    const auto picture_of = [&](const gi::Settings& settings) -> Result<io::Picture> {
        SUNFLECK_TRY(bench->renderer->lighting().set_settings(settings));
        return splat_picture(*bench, 0);
    };
    SUNFLECK_ASSIGN(io::Picture limit, picture_of(lobes({"", "none", "off"}, "65536")));
    SUNFLECK_ASSIGN(io::Picture beams, picture_of(lobes({"", "none", "on"}, "65536")));
    leave_caustic(limit);
    experiment.row("ring", "65,536 beams against 65,536 lobes of eq. 3", "relative MSE",
                   compare_pictures(beams, limit, true).relative_mean_square_error);
    for (const CausticWay& way : caustic_ways)
        for (const char* count : {"1024", "4096"}) {
            SUNFLECK_ASSIGN(const io::Picture picture, picture_of(lobes(way, count)));
            const std::string what = std::string(way.name) + ", " + count + " lights";
            const io::Picture& own = std::string_view(way.footprints) == "on" ? beams : limit;
            io::Picture expected = own;
            for (std::size_t i = 0; i < expected.pixels.size(); ++i)
                expected.pixels[i].w = limit.pixels[i].w;
            experiment.row("ring", what, "E to the limit of its shape",
                           compare_pictures(picture, expected, true).relative_mean_square_error,
                           "target: an eighth by each of importance and shape");
            experiment.row("ring", what, "E to 65,536 lobes of eq. 3",
                           compare_pictures(picture, limit, true).relative_mean_square_error);
            experiment.row("ring", what, "energy, relative", energy(picture, limit) / energy(limit, limit) - 1.0,
                           "target: within 0.05");
        }
    return {};
}

} // namespace sunfleck::command_line

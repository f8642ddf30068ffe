// The thesis's experiments that compare pictures.
#include "editor/command_line/metrics.h"
#include "editor/command_line/thesis_experiments.h"

#include <algorithm>

namespace sunfleck::command_line {
namespace {

// Share of the pixels that differ by more than 8/255 in a channel of their display values.
double share_off(const io::Picture& a, const io::Picture& b) {
    std::size_t off = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        const vec3 difference = glm::abs(vec3(a.pixels[i]) - vec3(b.pixels[i]));
        off += std::max({difference.x, difference.y, difference.z}) > 8.0f / 255.0f;
    }
    return double(off) / double(a.pixels.size());
}

Result<io::Picture> last_picture(Bench& bench, const gi::Settings& settings, std::uint32_t warmup,
                                 std::uint32_t frames) {
    SUNFLECK_TRY(bench.measure(settings, warmup, frames, true));
    return bench.renderer->read_back();
}

} // namespace

// Fig. 4-16: what shadows that lag behind their movers change in the picture, at some moments of a run.
Status lagging_shadows(Experiment& experiment) {
    SUNFLECK_ASSIGN(const auto bench, Bench::create(experiment.options, "four_pillars", "bench_1", thesis_size));
    SUNFLECK_ASSIGN(const auto current, Bench::create(experiment.options, "four_pillars", "bench_1", thesis_size));
    for (const std::uint32_t budget : {50u, 80u, 100u, 150u}) {
        double share = 0, error = 0;
        constexpr int moments = 4;
        for (int moment = 0; moment < moments; ++moment) {
            gi::Settings settings = many_light(300), all_maps = many_light(300);
            settings.map_budget = budget;
            all_maps.map_budget = 65536;
            SUNFLECK_ASSIGN(const io::Picture picture, last_picture(*bench, settings, 6, 12));
            SUNFLECK_ASSIGN(const io::Picture truth, last_picture(*current, all_maps, 6, 12));
            share += share_off(picture, truth) / moments;
            error += compare_pictures(picture, truth, false).mean_absolute_error * 255.0 / moments;
        }
        experiment.value("4-16", "four_pillars", "share of pixels off by more than 8/255, maps per frame", budget,
                         share, "against all affected maps current");
        experiment.value("4-16", "four_pillars", "mean difference in 1/255, maps per frame", budget, error, "");
    }
    return {};
}

namespace {

Status resolution_error(Experiment& experiment, const std::string& scene, const std::string& camera) {
    SUNFLECK_ASSIGN(const auto bench, Bench::create(experiment.options, scene, camera, thesis_size));
    const gi::Settings settings = many_light(300);
    gi::Settings full = settings;
    full.low_resolution = 1;
    const std::uint64_t step = bench->step;
    SUNFLECK_ASSIGN(const io::Picture picture, last_picture(*bench, settings, warm_up(settings), 1));
    bench->step = step;
    SUNFLECK_ASSIGN(const io::Picture truth, last_picture(*bench, full, warm_up(full), 1));
    const std::string where = scene + " " + camera;
    experiment.value("low resolution", where, "share of pixels off by more than 8/255", 300, share_off(picture, truth),
                     "against light at every pixel");
    return {};
}

} // namespace

// What is lost between the pixels of the low-resolution pass: shadows thinner than they are apart, above all.
Status resolution_errors(Experiment& experiment) {
    for (const std::string& scene : thesis_scenes)
        for (const std::string& camera : thesis_cameras.at(scene))
            SUNFLECK_TRY(resolution_error(experiment, scene, camera));
    return {};
}

// Fig. 5-8: direct light from few samples at several map resolutions, against 2,000 samples at the highest one.
Status map_quality(Experiment& experiment) {
    SUNFLECK_ASSIGN(const auto bench, Bench::create(experiment.options, "area_room", "bench_1", {320, 240}));
    bench->request.view = shared::view_irradiance;
    bench->request.tone_map = false;
    const auto picture = [&](gi::Settings settings) -> Result<io::Picture> {
        settings.with("indirect", "none");
        SUNFLECK_TRY(bench->measure(settings, settings.get("direct") == "light_samples" ? 5 : 0, 1, false));
        return bench->renderer->read_back();
    };
    gi::Settings truth = brute_force(2000);
    truth.shadow_map_resolution = 512;
    truth.shadow_memory = 2048.0f;
    SUNFLECK_ASSIGN(const io::Picture reference, picture(truth));
    for (const std::uint32_t lights : {25u, 50u, 100u})
        for (const std::uint32_t resolution : {64u, 128u, 256u, 512u}) {
            gi::Settings settings = many_light(lights);
            settings.shadow_map_resolution = resolution;
            settings.clamp_scale = 2000.0f / float(lights); // the same clamping bound for all
            settings.low_resolution = 1;                    // interpolation would dominate at this size
            SUNFLECK_ASSIGN(const io::Picture image, picture(settings));
            experiment.value("5-8", "area_room", "relative MSE, map resolution " + std::to_string(resolution), lights,
                             compare_pictures(image, reference, true).relative_mean_square_error,
                             "direct light against 2,000 samples");
        }
    return {};
}

} // namespace sunfleck::command_line

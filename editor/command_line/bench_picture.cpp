// How good the displayed picture of the quality presets is: edges, stains, crawling lines (picture_measures.h), and
// FLIP, against brute force with many samples at four times the size in each direction.
#include "editor/command_line/bench_runner.h"
#include "editor/command_line/metrics.h"
#include "editor/command_line/picture_measures.h"
#include "viewer/picture_settings.h"
#include "viewer/quality.h"

#include <cmath>

namespace sunfleck::command_line {
namespace {

constexpr Size displayed{640, 360};
constexpr std::uint32_t supersampling = 4;
constexpr std::uint32_t reference_samples = 1024, reference_map_side = 256;
constexpr std::uint32_t most_settling = 100; // frames
constexpr std::uint32_t moving_frames = 4;
constexpr float degrees_per_frame = 0.25f;

struct View {
    const char *scene, *camera;
};
constexpr View views[] = {{"lantern_house", "view"},       {"lantern_house", "hall"}, {"lantern_house", "red_room"},
                          {"lantern_house", "green_room"}, {"gap_room", "view"},      {"cornell", "view"},
                          {"two_rooms", "view"},           {"ring", "view"}};

// What is measured: a preset, with its filters or without.
struct ShownPreset {
    viewer::Quality quality;
    bool filtered;
    std::string name() const {
        const std::string preset = viewer::quality_presets()[std::size_t(quality)].name;
        return filtered ? preset : preset + ", shadow_filter and antialiasing off";
    }
};
constexpr ShownPreset shown_presets[] = {
    {viewer::Quality::software, false}, {viewer::Quality::software, true}, {viewer::Quality::high, true}};

gi::Settings settings_of(const ShownPreset& shown) {
    const viewer::QualityPreset& preset = viewer::quality_presets()[std::size_t(shown.quality)];
    gi::Settings settings = viewer::quality_settings(shown.quality, preset);
    settings.shadow_filter = shown.filtered;
    return settings;
}

gi::Settings reference_settings() {
    gi::Settings settings = gi::Settings().all_light_by("brute_force");
    settings.lights = reference_samples;
    settings.shadow_map_resolution = reference_map_side;
    settings.shadow_filter = true;
    return settings;
}

// `scale`: of the displayed size.
void set_size(viewer::FrameRequest& request, float render_scale, std::uint32_t scale) {
    request.screen_width = displayed.width * scale;
    request.screen_height = displayed.height * scale;
    request.width = std::uint32_t(std::lround(float(request.screen_width) * render_scale));
    request.height = std::uint32_t(std::lround(float(request.screen_height) * render_scale));
}

// Until the light of the first view is complete; no frame then differs from the next but by its camera.
Status settle(Bench& bench, const gi::Settings& settings) {
    SUNFLECK_TRY(bench.renderer->lighting().set_settings(settings));
    bench.request.camera = bench.start;
    for (std::uint32_t i = 0; i < most_settling; ++i) {
        SUNFLECK_TRY(bench.renderer->render_and_wait(bench.request));
        const gi::Report& counters = bench.renderer->lighting().counters();
        if (i > 0 && counters["shadow_maps_stale"] == 0.0 && counters["baked_light_waiting"] == 0.0)
            break;
    }
    return {};
}

struct TurningFrames {
    std::vector<io::Picture> pictures;
    double median_ms = 0.0;
};

// The camera turns from frame to frame, nothing else moves.
Result<TurningFrames> turning_frames(Bench& bench, std::uint32_t scale) {
    TurningFrames frames;
    frames.pictures.reserve(moving_frames);
    std::vector<double> times;
    for (std::uint32_t i = 0; i < moving_frames; ++i) {
        bench.request.camera = bench.start.orbited(glm::radians(degrees_per_frame) * float(i));
        SUNFLECK_TRY(bench.renderer->render_and_wait(bench.request));
        times.push_back(bench.renderer->statistics().frame_ms);
        SUNFLECK_ASSIGN(const io::Picture picture, bench.renderer->read_back());
        frames.pictures.push_back(box_filtered(picture, scale));
    }
    frames.median_ms = median(times);
    return frames;
}

Result<io::Picture> reference_picture(Bench& bench) {
    set_size(bench.request, 1.0f, supersampling);
    bench.request.antialiasing = false;
    SUNFLECK_TRY(bench.renderer->lighting().set_settings(reference_settings()));
    bench.request.camera = bench.start;
    SUNFLECK_TRY(bench.renderer->render_and_wait(bench.request));
    SUNFLECK_ASSIGN(const io::Picture picture, bench.renderer->read_back());
    return box_filtered(picture, supersampling);
}

Result<Json> measure(Bench& bench, const View& view, const ShownPreset& shown, const io::Picture& reference) {
    const float render_scale = viewer::quality_presets()[std::size_t(shown.quality)].render_scale;
    bench.request.antialiasing = shown.filtered;
    set_size(bench.request, render_scale, 1);
    SUNFLECK_TRY(settle(bench, settings_of(shown)));
    SUNFLECK_ASSIGN(const TurningFrames frames, turning_frames(bench, 1));
    set_size(bench.request, render_scale, supersampling);
    SUNFLECK_ASSIGN(const TurningFrames supersampled, turning_frames(bench, supersampling));
    const io::Picture& picture = frames.pictures.front();
    return Json{{"scene", view.scene},
                {"camera", view.camera},
                {"preset", shown.name()},
                {"frame_ms", frames.median_ms},
                {"flip", compare_pictures(picture, reference, false).flip},
                {"edges", edge_error(picture, reference)},
                {"stains", stain_share(picture, reference)},
                {"crawl", crawl(frames.pictures, supersampled.pictures)}};
}

} // namespace

Result<BenchTable> bench_picture(const BenchOptions& options) {
    BenchTable table;
    table.suite = "picture";
    table.notes = {{"size", {displayed.width, displayed.height}},
                   {"reference", "brute force, " + std::to_string(reference_samples) + " samples, maps of " +
                                     std::to_string(reference_map_side) + " texels, " + std::to_string(supersampling) +
                                     " times the size in each direction, box-filtered"}};
    for (const View& view : views) {
        if (!options.scene.empty() && options.scene != view.scene)
            continue;
        SUNFLECK_ASSIGN(const auto bench, Bench::create(options, view.scene, view.camera, displayed));
        bench->request.simulate = false;
        SUNFLECK_ASSIGN(const io::Picture reference, reference_picture(*bench));
        for (const ShownPreset& shown : shown_presets) {
            SUNFLECK_ASSIGN(Json row, measure(*bench, view, shown, reference));
            table.rows.push_back(std::move(row));
        }
        if (interrupted())
            return Error{"interrupted"};
    }
    if (table.rows.empty())
        return Error{"--scene '" + options.scene + "': the suite 'picture' has no view of it"};
    return table;
}

} // namespace sunfleck::command_line

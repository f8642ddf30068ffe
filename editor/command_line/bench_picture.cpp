// How good the displayed picture of the quality presets is: edges, stains, crawling lines (picture_measures.h) against
// brute force with many samples at four times the size in each direction, and FLIP against the path tracer. The presets
// as they were before filtered shadow maps and anti-aliasing came are measured beside them.
//
// A view takes about a minute and a half on two cores without a GPU, most of it for what it is compared with. With a
// folder, that and finished rows are kept, and the same command goes on where it was stopped.
#include "editor/command_line/bench_runner.h"
#include "editor/command_line/metrics.h"
#include "editor/command_line/picture_measures.h"
#include "engine/core/file.h"
#include "engine/render/tone_map.h"
#include "gi_module/reference/path_tracer.h"
#include "viewer/picture_settings.h"
#include "viewer/quality.h"

#include <cmath>
#include <cstdio>

namespace sunfleck::command_line {
namespace {

constexpr Size displayed{640, 360};
constexpr std::uint32_t supersampling = 4;
constexpr std::uint32_t reference_samples = 1024, reference_map_side = 256;
constexpr std::uint32_t most_settling = 100; // frames
constexpr std::uint32_t moving_frames = 4;
constexpr float degrees_per_frame = 0.25f;
constexpr std::uint32_t resting_frames = 40; // within which a picture in which nothing changes comes to rest

struct View {
    const char *scene, *camera;
};
// The first few are those of the first rooms that one sees, and of another scene.
constexpr View views[] = {
    {"lantern_house", "view"},       {"lantern_house", "hall"}, {"lantern_house", "red_room"}, {"cornell", "view"},
    {"lantern_house", "green_room"}, {"gap_room", "view"},      {"two_rooms", "view"},         {"ring", "view"}};

// What is measured: a preset, as it is or as it was.
struct ShownPreset {
    viewer::Quality quality;
    bool before;
    std::string preset() const { return viewer::quality_presets()[std::size_t(quality)].name; }
    std::string name() const { return before ? preset() + ", as it was before filters" : preset(); }
};
constexpr ShownPreset shown_presets[] = {{viewer::Quality::software, true},
                                         {viewer::Quality::software, false},
                                         {viewer::Quality::high, true},
                                         {viewer::Quality::high, false}};

gi::Settings settings_of(const ShownPreset& shown) {
    const viewer::QualityPreset& preset = viewer::quality_presets()[std::size_t(shown.quality)];
    gi::Settings settings = viewer::quality_settings(shown.quality, preset);
    if (shown.before) {
        settings.shadow_filter = false;
        settings.baked_samples = 0;
        settings.low_resolution = 2;
        settings.with("specular", "none");
    }
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
        if (i > 0 && counters["shadow_maps_stale"] == 0.0 && counters["baked_light_waiting"] == 0.0 &&
            counters["refined_light_waiting"] == 0.0)
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

// What one sees who stands still: pictures are also made from frame to frame then.
Result<io::Picture> picture_at_rest(Bench& bench) {
    bench.request.temporal = true;
    bench.request.camera = bench.start;
    for (std::uint32_t i = 0; i < resting_frames; ++i)
        SUNFLECK_TRY(bench.renderer->render_and_wait(bench.request));
    bench.request.temporal = false;
    return bench.renderer->read_back();
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

// As `reference --caustics off --antialiasing` shows it.
Result<io::Picture> traced_picture(Bench& bench, std::uint32_t samples, std::uint32_t seed) {
    viewer::SceneRenderer& renderer = *bench.renderer;
    SUNFLECK_ASSIGN(const auto rays, raytrace::RayScene::create()); // in the world, as emitters and camera are
    SUNFLECK_TRY(rays->update(renderer.registry(), renderer.meshes(), &renderer.textures()));
    const Bounds bounds = viewer::scene_bounds(renderer.registry(), renderer.meshes());
    const gi::reference::PathTracer tracer(*rays, gi::collect_emitters(renderer.registry(), renderer.meshes(), bounds),
                                           gi::collect_backgrounds(renderer.registry()));
    gi::reference::ReferenceSettings settings;
    settings.width = displayed.width;
    settings.height = displayed.height;
    settings.seed = seed;
    settings.caustics = false;
    settings.antialiasing = true;
    gi::reference::Accumulation sums;
    if (!tracer.accumulate(sums, bench.start, settings, samples, [] { return interrupted(); }))
        return Error{"interrupted"};
    io::Picture picture{settings.width, settings.height, {}};
    const float exposure = shared::exposure_factor(bench.request.ev100);
    for (std::size_t i = 0; i < sums.counts.size(); ++i) {
        const vec3 mean = vec3(sums.sums[3 * i], sums.sums[3 * i + 1], sums.sums[3 * i + 2]) / float(samples);
        picture.pixels.emplace_back(shared::display_from_radiance(mean, exposure), 1.0f);
    }
    return picture;
}

// What a folder keeps of the work, if there is one.
class Kept {
public:
    static Result<Kept> open(const BenchOptions& options) {
        Kept kept;
        kept.folder_ = options.folder;
        if (options.folder.empty())
            return kept;
        std::error_code code;
        std::filesystem::create_directories(kept.folder_, code);
        if (code)
            return Error{"--folder: cannot create '" + options.folder + "': " + code.message()};
        const std::filesystem::path file = kept.folder_ / "rows.json";
        if (!std::filesystem::exists(file, code))
            return kept;
        SUNFLECK_ASSIGN(const std::string text, read_file(file));
        kept.rows_ = Json::parse(text, nullptr, false);
        if (!kept.rows_.is_array())
            return Error{"--folder: '" + file.string() + "' has no rows of an experiment; remove it"};
        return kept;
    }

    // A picture of the view by name, made only once.
    template <typename Make>
    Result<io::Picture> picture(const View& view, const std::string& name, const Make& make) const {
        const std::filesystem::path file =
            folder_ / (std::string(view.scene) + "_" + view.camera + "_" + name + ".exr");
        std::error_code code;
        if (!folder_.empty() && std::filesystem::exists(file, code))
            return io::read_picture(file);
        SUNFLECK_ASSIGN(io::Picture made, make());
        if (!folder_.empty())
            SUNFLECK_TRY(io::write_picture(file, made));
        return made;
    }

    const Json* row(const View& view, const ShownPreset& shown) const {
        for (const Json& row : rows_)
            if (row.value("scene", "") == view.scene && row.value("camera", "") == view.camera &&
                row.value("preset", "") == shown.name() && row.contains("edges_at_rest"))
                return &row;
        return nullptr;
    }
    Status add(const Json& row) {
        rows_.push_back(row);
        return folder_.empty() ? Status() : write_file(folder_ / "rows.json", rows_.dump(1) + "\n");
    }

private:
    std::filesystem::path folder_;
    Json rows_ = Json::array();
};

// What a view's pictures are held against.
struct References {
    io::Picture smooth;    // brute force: without noise and stairs
    io::Picture traced[2]; // by two seeds
};

Result<References> references_of(Bench& bench, const View& view, const BenchOptions& options, const Kept& kept) {
    References references;
    SUNFLECK_ASSIGN(references.smooth, kept.picture(view, "brute_force", [&] { return reference_picture(bench); }));
    for (std::uint32_t i = 0; i < 2; ++i) {
        const std::string name = "traced_" + std::to_string(options.samples) + "_" + std::to_string(i + 1);
        SUNFLECK_ASSIGN(references.traced[i],
                        kept.picture(view, name, [&] { return traced_picture(bench, options.samples, i + 1); }));
    }
    return references;
}

Result<Json> measure(Bench& bench, const View& view, const ShownPreset& shown, const References& references) {
    const float render_scale = viewer::quality_presets()[std::size_t(shown.quality)].render_scale;
    bench.request.antialiasing = !shown.before;
    set_size(bench.request, render_scale, 1);
    SUNFLECK_TRY(settle(bench, settings_of(shown)));
    SUNFLECK_ASSIGN(const TurningFrames frames, turning_frames(bench, 1));
    const io::Picture& picture = frames.pictures.front();
    io::Picture at_rest = picture;
    if (!shown.before) {
        SUNFLECK_ASSIGN(at_rest, picture_at_rest(bench));
    }
    set_size(bench.request, render_scale, supersampling);
    SUNFLECK_ASSIGN(const TurningFrames supersampled, turning_frames(bench, supersampling));
    return Json{{"scene", view.scene},
                {"camera", view.camera},
                {"preset", shown.name()},
                {"frame_ms", frames.median_ms},
                {"P", compare_pictures(picture, references.traced[0], false).flip},
                {"P_of_seeds", compare_pictures(references.traced[1], references.traced[0], false).flip},
                {"edges", edge_error(picture, references.smooth)},
                {"edges_at_rest", edge_error(at_rest, references.smooth)},
                {"stains", stain_share(picture, references.smooth)},
                {"crawl", crawl(frames.pictures, supersampled.pictures)}};
}

// The rows of one view that are wanted, of which some may be there.
Status measure_view(const View& view, const BenchOptions& options, Kept& kept, BenchTable& table) {
    std::unique_ptr<Bench> bench;
    std::optional<References> references;
    for (const ShownPreset& shown : shown_presets) {
        if (!options.part.empty() && options.part != shown.preset())
            continue;
        std::fprintf(stderr, "picture: %s %s, %s\n", view.scene, view.camera, shown.name().c_str());
        if (const Json* row = kept.row(view, shown)) {
            table.rows.push_back(*row);
            continue;
        }
        if (!bench) {
            SUNFLECK_ASSIGN(bench, Bench::create(options, view.scene, view.camera, displayed));
            bench->request.simulate = false;
            SUNFLECK_ASSIGN(references, references_of(*bench, view, options, kept));
        }
        SUNFLECK_ASSIGN(const Json row, measure(*bench, view, shown, *references));
        SUNFLECK_TRY(kept.add(row));
        table.rows.push_back(row);
        if (interrupted())
            return Error{"interrupted"};
    }
    return {};
}

// Means over the views, of each preset over what it was.
void note_ratios(BenchTable& table) {
    for (const ShownPreset& shown : shown_presets) {
        if (shown.before)
            continue;
        Json ratios = Json::object();
        for (const char* measure : {"P", "edges", "edges_at_rest", "stains", "crawl", "frame_ms"}) {
            double now = 0.0, before = 0.0;
            for (const Json& row : table.rows) {
                now += row["preset"] == shown.name() ? row[measure].get<double>() : 0.0;
                before += row["preset"] == ShownPreset{shown.quality, true}.name() ? row[measure].get<double>() : 0.0;
            }
            if (before > 0.0)
                ratios[measure] = now / before;
        }
        if (!ratios.empty())
            table.notes[shown.name() + " over before"] = ratios;
    }
}

} // namespace

std::vector<std::string> picture_parts() {
    return {"software", "high"};
}

Result<BenchTable> bench_picture(const BenchOptions& options) {
    BenchTable table;
    table.suite = "picture";
    table.notes = {{"size", {displayed.width, displayed.height}},
                   {"P", "FLIP, against reference --caustics off, " + std::to_string(options.samples) +
                             " spp; P_of_seeds: of two seeds of that"},
                   {"edges_at_rest", "edges after 40 frames of standing still"},
                   {"edges, stains", "against brute force, " + std::to_string(reference_samples) +
                                         " samples, maps of " + std::to_string(reference_map_side) + " texels, " +
                                         std::to_string(supersampling) +
                                         " times the size in each direction, box-filtered"}};
    SUNFLECK_ASSIGN(Kept kept, Kept::open(options));
    std::uint32_t taken = 0;
    for (const View& view : views) {
        if ((!options.scene.empty() && options.scene != view.scene) || taken == options.views)
            continue;
        ++taken;
        SUNFLECK_TRY(measure_view(view, options, kept, table));
    }
    if (table.rows.empty())
        return Error{"--scene '" + options.scene + "': the suite 'picture' has no view of it"};
    note_ratios(table);
    return table;
}

} // namespace sunfleck::command_line

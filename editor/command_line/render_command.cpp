// sunfleck render: a picture of a scene by the real-time path.
#include "editor/command_line/commands.h"

#include "engine/core/file.h"
#include "engine/core/log.h"
#include "engine/core/memory_limit.h"
#include "engine/core/output.h"
#include "engine/core/user_folders.h"
#include "engine/statistics/sample_series.h"
#include "viewer/lost_devices.h"
#include "viewer/preparation.h"
#include "viewer/quality.h"
#include "viewer/trace.h"
#include "viewer/views.h"

#include <nlohmann/json.hpp>

namespace sunfleck::command_line {
namespace {

// Names that stand for a view with something else: settings, or lines over it.
const std::map<std::string, std::uint32_t> further_views = {
    {"direct", shared::view_irradiance}, {"indirect", shared::view_irradiance}, {"samples", shared::view_final}};

// Views of the picture; those of the lighting come from gi::debug_views().
const std::map<std::string, std::uint32_t>& picture_views() {
    static const std::map<std::string, std::uint32_t> all = [] {
        std::map<std::string, std::uint32_t> views = further_views;
        for (const viewer::PictureView& view : viewer::picture_views())
            views[std::string(view.name)] = view.code;
        return views;
    }();
    return all;
}

void set_view(const std::string& name, viewer::FrameRequest& request) {
    for (const gi::DebugView* view : gi::debug_views())
        if (view->name == name) {
            request.lighting_view = name;
            request.view = viewer::picture_view_of(*view);
            return;
        }
    request.view = picture_views().at(name);
    request.show_samples = name == "samples";
}

// The command line's options come before what the scene file says, that before their defaults.
Result<gi::Settings> make_settings(const RenderOptions& options, const std::map<std::string, std::string>& of_scene) {
    gi::Settings settings = viewer::usual_lighting();
    if (!options.statistics.empty() && gi::Settings::find("count_clamped") != nullptr)
        settings.with("count_clamped", "on");
    for (const auto& [name, value] : of_scene)
        SUNFLECK_TRY(settings.set(name, value));
    for (const auto& [name, value] : options.scene.lighting)
        SUNFLECK_TRY(settings.set(name, value));
    for (const std::string& assignment : options.settings)
        SUNFLECK_TRY(apply_setting(settings, assignment));
    if (options.view == "direct")
        settings.with("indirect", "none");
    if (options.view == "indirect")
        settings.with("direct", "none");
    SUNFLECK_TRY(settings.validate());
    return settings;
}

// What the command line and the scene file say about the picture.
Result<viewer::FrameRequest> make_request(const RenderOptions& options, viewer::SceneRenderer& renderer) {
    viewer::FrameRequest request;
    SUNFLECK_ASSIGN(const io::PictureKind kind, io::picture_kind(options.output));
    const Bounds bounds = viewer::scene_bounds(renderer.registry(), renderer.meshes());
    SUNFLECK_ASSIGN(request.camera, viewer::find_camera(renderer.registry(), bounds, options.scene.camera));
    request.width = options.scene.size.width;
    request.height = options.scene.size.height;
    set_view(options.view, request);
    request.tone_map = kind == io::PictureKind::png;
    request.antialiasing = options.picture.antialiasing;
    request.glare = options.picture.glare;
    request.ev100 = exposure_of(options.scene, renderer.registry()).value_or(viewer::default_exposure);
    return request;
}

// Of a scene that says no exposure: the last frame decides, and is then drawn again.
Status expose_automatically(const RenderOptions& options, viewer::SceneRenderer& renderer,
                            viewer::FrameRequest& request) {
    if (!request.tone_map || exposure_of(options.scene, renderer.registry()))
        return {};
    request.tone_map = false;
    SUNFLECK_TRY(renderer.render_and_wait(request));
    SUNFLECK_ASSIGN(const io::Picture radiance, renderer.read_back());
    request.ev100 = viewer::automatic_exposure(radiance, request.view == shared::view_irradiance);
    request.tone_map = true;
    return renderer.render_and_wait(request);
}

struct RenderedFrames {
    Measurement measurement;
    statistics::SampleSeries<double> frame_ms;
    statistics::SampleSeries<std::map<std::string, double>> cpu_ms, gpu_ms;
    viewer::Trace trace;
};

void note_frame(const viewer::FrameStatistics& statistics, bool traced, RenderedFrames& frames) {
    frames.frame_ms.add(statistics.frame_ms);
    frames.cpu_ms.add(statistics.cpu_ms);
    frames.gpu_ms.add(statistics.gpu_ms);
    frames.measurement.counters = statistics.counters;
    if (traced)
        frames.trace.add(statistics);
}

// The first frame makes all of the light; its shadow maps, of many triangles, can take minutes. Where light is refined,
// the same frame is drawn until it is.
Status draw(viewer::SceneRenderer& renderer, const viewer::FrameRequest& request, bool first) {
    if (!first)
        return renderer.render_and_wait(request);
    Progress progress("drawing the first picture with all of its light");
    viewer::FrameRequest watched = request;
    watched.passes_done = [&](double share) { progress.show(share, ""); };
    SUNFLECK_TRY(renderer.render_and_wait(watched));
    while (viewer::light_is_being_refined(renderer) && !interrupted())
        SUNFLECK_TRY(renderer.render_and_wait(request));
    return {};
}

// Leaves `request` as it was for the last frame.
Result<RenderedFrames> render_frames(const RenderOptions& options, viewer::SceneRenderer& renderer,
                                     viewer::FrameRequest& request) {
    const scene::CameraView start = request.camera;
    RenderedFrames frames;
    const std::uint32_t total = options.scene.warmup + options.scene.frames;
    Progress progress("rendering");
    const auto preparing = std::make_shared<Progress>("preparing the lighting");
    request.progress = [preparing, since = Stopwatch()](float share) {
        if (since.seconds() > 0.5)
            preparing->show(double(share), "");
        return !interrupted();
    };
    for (std::uint32_t frame = 0; frame < total; ++frame) {
        request.camera = camera_of_frame(start, options.scene, frame);
        request.step = step_of_frame(options.scene, frame);
        SUNFLECK_TRY(draw(renderer, request, frame == 0));
        if (interrupted())
            return Error{"interrupted; nothing was written"};
        if (frame >= options.scene.warmup)
            note_frame(renderer.statistics(), !options.trace.empty(), frames);
        if (total > 20)
            progress.show(double(frame + 1) / total, "");
    }
    frames.measurement.frames = frames.frame_ms.count();
    frames.measurement.frame_ms = frames.frame_ms.values();
    frames.measurement.cpu_ms = frames.cpu_ms.values();
    frames.measurement.gpu_ms = frames.gpu_ms.values();
    return frames;
}

Status write_statistics(const RenderOptions& options, viewer::SceneRenderer& renderer,
                        const viewer::FrameRequest& request, gpu::Device& device, Measurement measurement) {
    // What the GPU counted reaches the CPU one frame later.
    SUNFLECK_TRY(renderer.render_and_wait(request));
    measurement.counters.take_gpu_counts(renderer.statistics().counters);
    measurement.scene = options.scene.scene;
    measurement.settings = renderer.lighting().settings();
    measurement.size = {request.width, request.height};
    measurement.ev100 = request.ev100;
    measurement.memory = device.memory().usage();
    return write_file(options.statistics, json_text(measurement_json(device, measurement)) + "\n");
}

Status render_on_new_device(const RenderOptions& options, const std::filesystem::path& path) {
    SUNFLECK_ASSIGN(const auto device, gpu::Device::create({options.scene.device, options.scene.validation, {}}));
    SUNFLECK_ASSIGN(const auto renderer, viewer::SceneRenderer::create(*device));
    renderer->lighting().set_cache_folder(user_cache_folder());
    SUNFLECK_ASSIGN(const io::ImportReport report,
                    renderer->load(path, import_options(options.scene), [&](ecs::Registry& registry) {
                        return apply_environment(options.scene, registry);
                    }));
    for (const std::string& note : report.notes)
        log_warning(note);
    SUNFLECK_ASSIGN(const gi::Settings settings, make_settings(options, report.settings));
    SUNFLECK_TRY(renderer->lighting().set_settings(settings));

    SUNFLECK_ASSIGN(viewer::FrameRequest request, make_request(options, *renderer));
    SUNFLECK_ASSIGN(const RenderedFrames frames, render_frames(options, *renderer, request));
    SUNFLECK_TRY(expose_automatically(options, *renderer, request));
    SUNFLECK_ASSIGN(const io::Picture picture, renderer->read_back());
    SUNFLECK_TRY(io::write_picture(options.output, picture));
    if (!options.trace.empty())
        SUNFLECK_TRY(frames.trace.write(options.trace));
    if (options.print_graph)
        std::fputs(renderer->print_graph().c_str(), stdout);
    if (!options.statistics.empty())
        SUNFLECK_TRY(write_statistics(options, *renderer, request, *device, frames.measurement));
    if (device->validation_messages() > 0)
        return Error{std::to_string(device->validation_messages()) + " validation messages (see above)"};
    return {};
}

} // namespace

std::vector<std::string> view_names() {
    std::vector<std::string> names;
    names.reserve(picture_views().size() + gi::debug_views().size());
    for (const auto& [name, view] : picture_views())
        names.push_back(name);
    for (const gi::DebugView* view : gi::debug_views())
        names.emplace_back(view->name);
    return names;
}

Status render(const RenderOptions& options) {
    // What is wrong on the command line, before anything is loaded.
    SUNFLECK_TRY(io::picture_kind(options.output));
    SUNFLECK_TRY(make_settings(options, {}));
    set_memory_limit(std::uint64_t(options.scene.memory_mib) << 20);
    SUNFLECK_TRY(viewer::SceneRenderer::check_size(options.scene.size.width, options.scene.size.height));
    SUNFLECK_ASSIGN(const std::filesystem::path path, find_scene(options.scene.scene));
    const NamedFile outputs[] = {{"-o", options.output}, {"--stats", options.statistics}, {"--trace", options.trace}};
    const NamedFile inputs[] = {{"SCENE", path}, {"--environment", options.scene.environment}};
    SUNFLECK_TRY(try_outputs(outputs, inputs));
    return viewer::survive_lost_devices([&] { return render_on_new_device(options, path); });
}

} // namespace sunfleck::command_line

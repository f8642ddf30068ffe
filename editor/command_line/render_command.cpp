// sunfleck render: a picture of a scene by the real-time path.
#include "editor/command_line/commands.h"

#include "engine/core/file.h"
#include "engine/core/log.h"

#include <nlohmann/json.hpp>

namespace sunfleck::command_line {
namespace {

// Views that the lighting itself draws, in false colours.
const std::map<std::string, std::uint32_t> lighting_views = {
    {"tiles", shared::show_tiles},           {"repaired", shared::show_repaired},
    {"visibility", shared::show_visibility}, {"staleness", shared::show_staleness},
    {"light_maps", shared::show_light_maps}, {"baked", shared::show_baked}};

const std::map<std::string, std::uint32_t> views = {{"final", shared::view_final},
                                                    {"irradiance", shared::view_irradiance},
                                                    {"direct", shared::view_irradiance},
                                                    {"indirect", shared::view_irradiance},
                                                    {"normals", shared::view_normals},
                                                    {"albedo", shared::view_albedo},
                                                    {"depth", shared::view_depth},
                                                    {"surfaces", shared::view_surfaces},
                                                    {"motion", shared::view_motion},
                                                    {"samples", shared::view_final},
                                                    {"tiles", shared::view_false_colours},
                                                    {"repaired", shared::view_false_colours},
                                                    {"visibility", shared::view_false_colours},
                                                    {"staleness", shared::view_false_colours},
                                                    {"light_maps", shared::view_irradiance},
                                                    {"baked", shared::view_false_colours}};

// The command line's options come before what the scene file says, that before their defaults.
Result<gi::Settings> make_settings(const RenderOptions& options, const std::map<std::string, std::string>& of_scene) {
    gi::Settings settings;
    SUNFLECK_TRY(apply_setting(settings, "direct=" + options.direct));
    SUNFLECK_TRY(apply_setting(settings, "indirect=" + options.indirect));
    SUNFLECK_TRY(apply_setting(settings, "movers=" + options.scene.movers));
    settings.lights = options.lights;
    settings.direct_share = options.direct_share;
    settings.bounces = options.scene.bounces;
    settings.seed = options.scene.seed;
    settings.count_clamped = !options.statistics.empty();
    for (const auto& [name, value] : of_scene)
        if (!options.given.count(name))
            SUNFLECK_TRY(apply_setting(settings, name + "=" + value));
    for (const std::string& assignment : options.settings)
        SUNFLECK_TRY(apply_setting(settings, assignment));
    if (options.view == "direct")
        settings.indirect = gi::IndirectTechnique::none;
    if (options.view == "indirect")
        settings.direct = gi::DirectTechnique::none;
    return settings;
}

} // namespace

std::vector<std::string> view_names() {
    std::vector<std::string> names;
    for (const auto& [name, view] : views)
        names.push_back(name);
    return names;
}

Status render(const RenderOptions& options) {
    SUNFLECK_ASSIGN(const io::PictureKind kind, io::picture_kind(options.output));
    SUNFLECK_ASSIGN(const Size size, parse_size(options.scene.size));
    SUNFLECK_ASSIGN(const std::filesystem::path path, find_scene(options.scene.scene));
    SUNFLECK_TRY(make_settings(options, {})); // what is wrong on the command line, before anything is loaded
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
    const Bounds bounds = viewer::scene_bounds(renderer->registry(), renderer->meshes());
    SUNFLECK_ASSIGN(const scene::CameraView camera,
                    viewer::find_camera(renderer->registry(), bounds, options.scene.camera));

    viewer::FrameRequest request;
    request.width = size.width;
    request.height = size.height;
    request.view = views.at(options.view);
    if (const auto found = lighting_views.find(options.view); found != lighting_views.end()) {
        if (options.direct == "brute_force" || options.indirect == "brute_force")
            return Error{"--view " + options.view +
                         " shows the technique light_samples; brute_force has no such thing"};
        request.show = found->second;
    }
    request.tone_map = kind == io::PictureKind::png;
    request.show_samples = options.view == "samples";
    request.ev100 = options.scene.ev100 > -100.0f ? options.scene.ev100 : viewer::scene_exposure(renderer->registry());
    Measurement measurement;
    const std::uint32_t total = options.scene.warmup + options.scene.frames;
    Progress progress("rendering");
    for (std::uint32_t frame = 0; frame < total; ++frame) {
        request.camera = camera_of_frame(camera, options.scene, frame);
        request.step = step_of_frame(options.scene, frame);
        SUNFLECK_TRY(renderer->render_and_wait(request));
        if (interrupted())
            return Error{"interrupted; nothing was written"};
        if (frame >= options.scene.warmup) {
            const viewer::FrameStatistics& statistics = renderer->statistics();
            measurement.frame_ms.push_back(statistics.frame_ms);
            measurement.cpu_ms.push_back(statistics.cpu_ms);
            measurement.gpu_ms.push_back(statistics.gpu_ms);
            measurement.counters = statistics.counters;
        }
        if (total > 20)
            progress.show(double(frame + 1) / total, "");
    }
    SUNFLECK_ASSIGN(const io::Picture picture, renderer->read_back());
    SUNFLECK_TRY(io::write_picture(options.output, picture));
    if (options.print_graph)
        std::fputs(renderer->print_graph().c_str(), stdout);
    if (!options.statistics.empty()) {
        // What the GPU counted reaches the CPU one frame later.
        SUNFLECK_TRY(renderer->render_and_wait(request));
        const gi::Counters& newest = renderer->statistics().counters;
        measurement.counters.clamped_flux = newest.clamped_flux;
        measurement.counters.clamped_irradiance = newest.clamped_irradiance;
        measurement.counters.pixels = newest.pixels;
        measurement.scene = options.scene.scene;
        measurement.settings = settings;
        measurement.size = size;
        measurement.memory = device->memory().usage();
        SUNFLECK_TRY(write_file(options.statistics, measurement_json(*device, measurement).dump(2) + "\n"));
    }
    if (device->validation_messages() > 0)
        return Error{std::to_string(device->validation_messages()) + " validation messages (see above)"};
    return {};
}

} // namespace sunfleck::command_line

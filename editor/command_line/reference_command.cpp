// sunfleck reference: the path tracer, progressive; can be interrupted and goes on where it was.
#include "editor/command_line/commands.h"

#include "engine/core/caught.h"
#include "engine/core/file.h"
#include "engine/core/hash.h"
#include "engine/core/log.h"
#include "engine/core/memory_limit.h"
#include "engine/core/output.h"
#include "engine/core/stop_signals.h"
#include "engine/render/tone_map.h"
#include "engine/scene/deformation.h"
#include "engine/simulation/path_movers.h"
#include "gi_module/reference/accumulation_file.h"
#include "gi_module/reference/light_tracer.h"

#include <chrono>
#include <nlohmann/json.hpp>

namespace sunfleck::command_line {
namespace {

using namespace gi::reference;

std::uint64_t hash_text(const std::string& text) {
    return hash_bytes(hash_start, text.data(), text.size());
}

// Sums (three doubles), counts and coverage, once more as the bytes of the file that is saved, and the picture itself.
constexpr std::uint64_t bytes_per_pixel = 2 * (3 * sizeof(double) + 5) + sizeof(vec4);

io::Picture to_picture(const Accumulation& accumulation, bool display, bool irradiance, float ev100) {
    io::Picture picture;
    picture.width = accumulation.width;
    picture.height = accumulation.height;
    picture.pixels.resize(std::size_t(picture.width) * picture.height);
    const double scale = accumulation.samples > 0 ? 1.0 / accumulation.samples : 0.0;
    for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
        const vec3 mean(accumulation.sums[i * 3] * scale, accumulation.sums[i * 3 + 1] * scale,
                        accumulation.sums[i * 3 + 2] * scale);
        if (display)
            picture.pixels[i] = vec4(
                shared::display_from_radiance(irradiance ? mean / pi : mean, shared::exposure_factor(ev100)), 1.0f);
        else
            picture.pixels[i] = vec4(mean, irradiance && accumulation.covered[i] == 0 ? 0.0f : 1.0f);
    }
    return picture;
}

// Everything that is loaded to trace one frame.
struct TracedScene {
    ecs::Registry registry;
    scene::MeshStore meshes;
    scene::TextureStore textures;
    std::unique_ptr<raytrace::RayScene> rays;
    Bounds bounds;
    scene::CameraView camera;
    std::uint32_t last_frame = 0;
    std::uint64_t content_hash = hash_start; // of the bytes of all files that were read
};

// Every surface Lambertian, of its base colour alone, as other renderers can be asked for, too.
void make_lambertian(ecs::Registry& registry) {
    std::vector<ecs::Entity> found;
    registry.view<scene::Material>().each([&](ecs::Entity entity, const scene::Material&) { found.push_back(entity); });
    for (const ecs::Entity entity : found) {
        registry.patch<scene::Material>(entity, [](scene::Material& material) {
            material.metallic = material.transmission = 0.0f;
            material.specular = false;
        });
        if (registry.has<scene::MaterialTextures>(entity))
            registry.patch<scene::MaterialTextures>(entity, [](scene::MaterialTextures& textures) {
                textures.metallic_roughness = textures.normal = textures.transmission = {};
            });
        if (registry.has<scene::SurfacePattern>(entity))
            registry.remove<scene::SurfacePattern>(entity);
    }
}

Status load(const ReferenceOptions& options, const std::filesystem::path& path, TracedScene& scene) {
    io::ImportOptions import = import_options(options.scene);
    import.content_hash = &scene.content_hash;
    SUNFLECK_ASSIGN(const io::ImportReport report,
                    io::load_scene(path, scene.registry, scene.meshes, scene.textures, import));
    SUNFLECK_TRY(apply_environment(options.scene, scene.registry, &scene.content_hash));
    if (report.default_light)
        viewer::add_default_light(scene.registry);
    if (options.lambertian)
        make_lambertian(scene.registry);
    scene.last_frame = options.scene.warmup + options.scene.frames - 1;
    simulation::set_movers_to_step(scene.registry, step_of_frame(options.scene, scene.last_frame));
    SUNFLECK_ASSIGN(scene.rays, raytrace::RayScene::create());
    scene::deform_meshes(scene.registry, scene.meshes);
    SUNFLECK_TRY(scene.rays->update(scene.registry, scene.meshes, &scene.textures,
                                    viewer::progress_until_stopped("preparing rays")));
    scene.bounds = viewer::scene_bounds(scene.registry, scene.meshes);
    SUNFLECK_ASSIGN(const scene::CameraView start,
                    viewer::find_camera(scene.registry, scene.bounds, options.scene.camera));
    scene.camera = camera_of_frame(start, options.scene, scene.last_frame);
    return {};
}

Result<ReferenceSettings> settings_of(const ReferenceOptions& options) {
    gi::Settings lighting;
    for (const auto& [name, value] : options.scene.lighting)
        SUNFLECK_TRY(lighting.set(name, value));
    ReferenceSettings settings;
    settings.width = options.scene.size.width;
    settings.height = options.scene.size.height;
    settings.bounces = options.unlimited ? unlimited_bounces : lighting.bounces;
    settings.seed = lighting.seed;
    settings.antialiasing = options.antialiasing;
    settings.caustics = options.caustics;
    settings.view = options.view == "irradiance" ? ReferenceView::irradiance
                    : options.view == "direct"   ? ReferenceView::direct
                    : options.view == "indirect" ? ReferenceView::indirect
                                                 : ReferenceView::radiance;
    return settings;
}

// Of all that decides the picture: a state with another key is not resumed. The bytes of all files are in content_hash.
std::uint64_t picture_key(const ReferenceOptions& options, const ReferenceSettings& settings,
                          const TracedScene& scene) {
    const SceneOptions& of = options.scene;
    Json json = {{"method", reference_method},
                 {"content", scene.content_hash},
                 {"scene", of.import.scene},
                 {"variant", of.import.variant},
                 {"animation", of.import.animation},
                 {"environment", !of.environment.empty()},
                 {"lighting", of.lighting},
                 {"size", {settings.width, settings.height}},
                 {"camera", of.camera},
                 {"orbit", of.orbit_degrees},
                 {"frame", scene.last_frame},
                 {"motion", of.motion},
                 {"view", options.view},
                 {"bounces", settings.bounces},
                 {"seed", settings.seed},
                 {"antialiasing", settings.antialiasing},
                 {"caustics", settings.caustics},
                 {"lambertian", options.lambertian}};
    if (options.light_paths)
        json["light_paths"] = true;
    return hash_text(json.dump(-1, ' ', false, Json::error_handler_t::replace));
}

// A picture on its way to options.samples a pixel, saved now and then.
class Tracing {
public:
    Tracing(const ReferenceOptions& options, TracedScene& scene, const ReferenceSettings& settings,
            SavedAccumulation& state)
        : options_(options), scene_(scene), settings_(settings), state_(state), clock_(options.save_interval) {
        std::set<ecs::Entity> warned_of; // lights that are ignored
        const std::vector<gi::Emitter> emitters =
            gi::collect_emitters(scene.registry, scene.meshes, scene.bounds, {}, {}, &warned_of);
        if (options.light_paths)
            light_tracer_.emplace(*scene.rays, emitters, gi::collect_backgrounds(scene.registry));
        else
            tracer_.emplace(*scene.rays, emitters, gi::collect_backgrounds(scene.registry));
    }

    // Takes up the saved state, if there is one.
    Status resume() {
        SUNFLECK_ASSIGN(accumulation_, state_.load());
        const std::vector<std::uint32_t>& counts = accumulation_.counts;
        // A state may have more samples than are asked for now: all pixels then get as many.
        goal_ = counts.empty() ? options_.samples
                               : std::max(options_.samples, *std::max_element(counts.begin(), counts.end()));
        rays_before_ = accumulation_.rays;
        if (!counts.empty())
            std::fprintf(stderr, "going on from %u samples per pixel in '%s'\n", accumulation_.samples,
                         state_.newest().c_str());
        return {};
    }

    // An error where it was stopped, by a signal or a failure; what is there is saved then.
    Status run() {
        const Status traced = caught([&]() -> Status { return trace(); });
        if (traced && accumulation_.samples >= goal_)
            return {};
        // Sums and counts are whole: nothing fails while samples are added to them.
        const Error why = traced ? Error{"stopped by " + signal_name(stop_signal())} : traced.error();
        if (const Status saved = save(); !saved)
            return Error{why.message + "; " + saved.error().message, why.code};
        return Error{why.message + "; the same command goes on from '" + state_.newest().string() + "'", why.code};
    }

    Status save() {
        const Stopwatch watch;
        Status status = caught([&]() -> Status { return state_.save(accumulation_); });
        clock_.saved(watch.seconds());
        return status;
    }

    const Accumulation& accumulation() const { return accumulation_; }
    double seconds() const { return seconds_; }
    double rays_per_second() const { return double(accumulation_.rays - rays_before_) / std::max(seconds_, 1e-9); }

private:
    Status trace() {
        const Stopwatch watch;
        Progress progress("reference");
        while (accumulation_.samples < goal_ && !interrupted()) {
            trace_for(std::min(0.5, 0.5 * double(options_.save_interval)));
            seconds_ = watch.seconds();
            show(progress);
            // What can't be saved now may be later; the work goes on.
            if (clock_.is_time())
                if (const Status status = save(); !status)
                    log_warning(status.error().message);
        }
        return {};
    }
    // Few samples first, so that an early stop has something to show.
    void trace_for(double slice) {
        const std::uint32_t batch = std::min({std::max(1u, accumulation_.samples), 16u, goal_ - accumulation_.samples});
        const Stopwatch watch;
        const auto cancelled = [&] { return interrupted() || watch.seconds() > slice; };
        if (light_tracer_)
            light_tracer_->accumulate(accumulation_, scene_.camera, settings_, batch, cancelled);
        else
            tracer_->accumulate(accumulation_, scene_.camera, settings_, batch, cancelled);
    }
    void show(Progress& progress) const {
        double samples = 0.0;
        for (const std::uint32_t count : accumulation_.counts)
            samples += double(count);
        char detail[96];
        std::snprintf(detail, sizeof detail, "%u of %u spp, %.2f million rays/s", accumulation_.samples, goal_,
                      rays_per_second() * 1e-6);
        progress.show(samples / (double(goal_) * double(accumulation_.counts.size())), detail);
    }

    const ReferenceOptions& options_;
    const TracedScene& scene_;
    const ReferenceSettings& settings_;
    SavedAccumulation& state_;
    SaveClock clock_;
    std::optional<PathTracer> tracer_; // one of the two
    std::optional<LightTracer> light_tracer_;
    Accumulation accumulation_;
    std::uint32_t goal_ = 0;
    std::uint64_t rays_before_ = 0;
    double seconds_ = 0.0;
};

Status write_statistics(const ReferenceOptions& options, const Tracing& tracing, float ev100) {
    const Json json = {{"scene", options.scene.scene},
                       {"samples_per_pixel", tracing.accumulation().samples},
                       {"ev100", ev100},
                       {"seconds", tracing.seconds()},
                       {"rays", tracing.accumulation().rays},
                       {"rays_per_second", tracing.rays_per_second()}};
    return write_file(options.statistics, json_text(json) + "\n");
}

Status write_results(const ReferenceOptions& options, TracedScene& scene, const ReferenceSettings& settings,
                     const Tracing& tracing) {
    const bool irradiance = settings.view != ReferenceView::radiance;
    const std::optional<float> said = exposure_of(options.scene, scene.registry);
    const Accumulation& sums = tracing.accumulation();
    const float ev100 =
        said ? *said
             : viewer::automatic_exposure(to_picture(sums, false, irradiance, viewer::default_exposure), irradiance);
    SUNFLECK_ASSIGN(const io::PictureKind kind, io::picture_kind(options.output));
    SUNFLECK_TRY(io::write_picture(options.output, to_picture(sums, kind == io::PictureKind::png, irradiance, ev100)));
    return options.statistics.empty() ? Status() : write_statistics(options, tracing, ev100);
}

// What would fail hours later fails now.
Status try_files(const ReferenceOptions& options, const std::filesystem::path& scene) {
    const SavedAccumulation state(options.output + ".state", 0);
    const NamedFile outputs[] = {{"-o", options.output},
                                 {"--stats", options.statistics},
                                 {"the state of -o", state.file(0)},
                                 {"the state of -o", state.file(1)}};
    const NamedFile inputs[] = {{"SCENE", scene}, {"--environment", options.scene.environment}};
    SUNFLECK_TRY(try_outputs(outputs, inputs));
    return try_output(state.file(0), SavedAccumulation::bytes(options.scene.size.width, options.scene.size.height));
}

} // namespace

Status reference(const ReferenceOptions& options) {
    SUNFLECK_TRY(io::picture_kind(options.output));
    set_memory_limit(std::uint64_t(options.scene.memory_mib) << 20);
    const Size size = options.scene.size;
    SUNFLECK_TRY(check_memory(bytes_per_pixel * size.width * size.height,
                              "a picture of " + std::to_string(size.width) + "x" + std::to_string(size.height),
                              "--size"));
    SUNFLECK_ASSIGN(const std::filesystem::path path, find_scene(options.scene.scene));
    SUNFLECK_TRY(try_files(options, path));
    TracedScene scene;
    SUNFLECK_TRY(load(options, path, scene));
    SUNFLECK_ASSIGN(const ReferenceSettings settings, settings_of(options));
    SavedAccumulation state(options.output + ".state", picture_key(options, settings, scene));
    Tracing tracing(options, scene, settings, state);
    SUNFLECK_TRY(tracing.resume());
    watch_stop_signals();
    SUNFLECK_TRY(tracing.run());
    if (const Status status = write_results(options, scene, settings, tracing); !status) {
        const Status saved = tracing.save();
        return Error{status.error().message + "; " +
                     (saved ? "once that is mended, the same command ends at once: all samples are in '" +
                                  state.newest().string() + "'"
                            : saved.error().message + "; the same command goes on from the state saved before")};
    }
    state.remove();
    return {};
}

} // namespace sunfleck::command_line

// sunfleck reference: the path tracer, progressive; can be interrupted and goes on where it was.
#include "editor/command_line/commands.h"

#include "engine/core/file.h"
#include "engine/core/hash.h"
#include "engine/render/tone_map.h"
#include "engine/scene/deformation.h"
#include "engine/simulation/path_movers.h"
#include "gi_module/reference/path_tracer.h"

#include <chrono>
#include <nlohmann/json.hpp>

namespace sunfleck::command_line {
namespace {

using namespace gi::reference;

std::uint64_t hash_text(const std::string& text) {
    return hash_bytes(hash_start, text.data(), text.size());
}

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

Result<Accumulation> start_or_resume(const std::string& state_file, std::uint64_t hash) {
    std::error_code code;
    if (!std::filesystem::exists(state_file, code))
        return Accumulation{};
    SUNFLECK_ASSIGN(Accumulation accumulation, load_accumulation(state_file, hash));
    std::fprintf(stderr, "going on from %u samples per pixel in '%s'\n", accumulation.samples, state_file.c_str());
    return accumulation;
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
    SUNFLECK_TRY(io::load_scene(path, scene.registry, scene.meshes, scene.textures, import_options(options.scene)));
    SUNFLECK_TRY(apply_environment(options.scene, scene.registry));
    viewer::add_default_light(scene.registry);
    if (options.lambertian)
        make_lambertian(scene.registry);
    scene.last_frame = options.scene.warmup + options.scene.frames - 1;
    simulation::set_movers_to_step(scene.registry, step_of_frame(options.scene, scene.last_frame));
    SUNFLECK_ASSIGN(scene.rays, raytrace::RayScene::create());
    scene::deform_meshes(scene.registry, scene.meshes);
    SUNFLECK_TRY(scene.rays->update(scene.registry, scene.meshes, &scene.textures));
    scene.bounds = viewer::scene_bounds(scene.registry, scene.meshes);
    SUNFLECK_ASSIGN(const scene::CameraView start,
                    viewer::find_camera(scene.registry, scene.bounds, options.scene.camera));
    scene.camera = camera_of_frame(start, options.scene, scene.last_frame);
    return {};
}

Result<ReferenceSettings> settings_of(const ReferenceOptions& options, Size size) {
    gi::Settings lighting;
    for (const auto& [name, value] : options.scene.lighting)
        SUNFLECK_TRY(lighting.set(name, value));
    ReferenceSettings settings;
    settings.width = size.width;
    settings.height = size.height;
    settings.bounces = options.unlimited ? unlimited_bounces : lighting.bounces;
    settings.seed = lighting.seed;
    settings.antialiasing = options.antialiasing;
    settings.view = options.view == "irradiance" ? ReferenceView::irradiance
                    : options.view == "direct"   ? ReferenceView::direct
                    : options.view == "indirect" ? ReferenceView::indirect
                                                 : ReferenceView::radiance;
    return settings;
}

// Of all that decides the picture; a state with another hash is not resumed.
Result<std::uint64_t> hash_of(const ReferenceOptions& options, const std::filesystem::path& path,
                              const ReferenceSettings& settings, std::uint32_t last_frame) {
    SUNFLECK_ASSIGN(const std::string scene_bytes, read_file(path));
    constexpr const char* method = "2"; // raised with whatever makes the tracer's pictures differ
    return hash_text(scene_bytes + "|" + method + "|" + path.string() + "|" + options.scene.size + "|" +
                     options.scene.camera + "|" + options.view + "|" + std::to_string(settings.bounces) + "|" +
                     std::to_string(settings.seed) + "|" + std::to_string(last_frame) + "|" +
                     std::to_string(options.scene.motion) + "|" + std::to_string(options.scene.orbit_degrees) + "|" +
                     std::to_string(options.antialiasing) + "|" + std::to_string(options.lambertian));
}

// Traces until there are options.samples a pixel; false if the user stopped it. Returns the seconds that it took.
Result<double> trace(const ReferenceOptions& options, TracedScene& scene, const ReferenceSettings& settings,
                     Accumulation& accumulation, bool& complete) {
    const PathTracer tracer(*scene.rays, gi::collect_emitters(scene.registry, scene.meshes, scene.bounds),
                            gi::collect_backgrounds(scene.registry));
    const auto began = std::chrono::steady_clock::now();
    const auto seconds = [&] {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    };
    const std::uint64_t rays_before = accumulation.rays;
    Progress progress("reference");
    complete = true;
    while (accumulation.samples < options.samples && complete) {
        // Few samples first, so that an early interrupt has something to show.
        const std::uint32_t batch =
            std::min({std::max(1u, accumulation.samples), 16u, options.samples - accumulation.samples});
        complete = tracer.accumulate(accumulation, scene.camera, settings, batch, interrupted);
        char detail[96];
        std::snprintf(detail, sizeof detail, "%u of %u spp, %.2f million rays/s", accumulation.samples, options.samples,
                      double(accumulation.rays - rays_before) / seconds() * 1e-6);
        progress.show(double(accumulation.samples) / options.samples, detail);
    }
    return seconds();
}

} // namespace

Status reference(const ReferenceOptions& options) {
    SUNFLECK_ASSIGN(const io::PictureKind kind, io::picture_kind(options.output));
    SUNFLECK_ASSIGN(const Size size, parse_size(options.scene.size));
    SUNFLECK_ASSIGN(const std::filesystem::path path, find_scene(options.scene.scene));
    TracedScene scene;
    SUNFLECK_TRY(load(options, path, scene));
    SUNFLECK_ASSIGN(const ReferenceSettings settings, settings_of(options, size));
    SUNFLECK_ASSIGN(const std::uint64_t hash, hash_of(options, path, settings, scene.last_frame));
    const std::string state_file = options.output + ".state";
    SUNFLECK_ASSIGN(Accumulation accumulation, start_or_resume(state_file, hash));
    const std::uint64_t rays_before = accumulation.rays;
    bool complete = false;
    SUNFLECK_ASSIGN(const double seconds, trace(options, scene, settings, accumulation, complete));
    if (!complete) {
        SUNFLECK_TRY(save_accumulation(state_file, accumulation, hash));
        return Error{"interrupted; the same command goes on from '" + state_file + "'"};
    }
    const bool irradiance = settings.view != ReferenceView::radiance;
    const std::optional<float> said = exposure_of(options.scene, scene.registry);
    const float ev100 = said ? *said
                             : viewer::automatic_exposure(
                                   to_picture(accumulation, false, irradiance, viewer::default_exposure), irradiance);
    SUNFLECK_TRY(
        io::write_picture(options.output, to_picture(accumulation, kind == io::PictureKind::png, irradiance, ev100)));
    std::error_code code;
    std::filesystem::remove(state_file, code);
    if (options.statistics.empty())
        return {};
    const Json json = {{"scene", options.scene.scene},
                       {"samples_per_pixel", accumulation.samples},
                       {"ev100", ev100},
                       {"seconds", seconds},
                       {"rays", accumulation.rays},
                       {"rays_per_second", double(accumulation.rays - rays_before) / seconds}};
    return write_file(options.statistics, json.dump(2) + "\n");
}

} // namespace sunfleck::command_line

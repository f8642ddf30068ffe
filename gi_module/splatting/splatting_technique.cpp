#include "gi_module/splatting/splatting_technique.h"

#include <algorithm>

namespace sunfleck::gpu {
std::span<const EmbeddedShader> sunfleck_gi_splatting_shaders();
}

namespace sunfleck::gi {
namespace {

constexpr Counter pixel_lights{"splats", "lights", "splatting", "Pixel lights whose light is splatted"};
constexpr Counter reflective_maps{"reflective_maps", "maps", "splatting",
                                  "Reflective shadow maps that pixel lights are chosen from"};
constexpr Counter reflective_rays{"reflective_map_rays", "rays", "splatting",
                                  "Texels of reflective shadow maps that were made in this frame"};
constexpr Counter occlusion_rays{"splat_occlusion_rays", "rays", "splatting",
                                 "Texels of shadow maps of pixel lights that were traced in this frame"};
constexpr Counter memory{"splatting", "B", memory_group, "Reflective shadow maps, pixel lights and lists of tiles"};
constexpr Counter technique_counters[] = {pixel_lights, reflective_maps, reflective_rays, occlusion_rays, memory};

constexpr DebugView technique_views[] = {
    {"splats", "Where the pixel lights are, in their colours", "dots: pixel lights", "", "splatting",
     shared::show_splat_places, true},
    {"overdraw", "Pixel lights that are evaluated for a pixel", "white: 256", "", "splatting", shared::show_overdraw,
     true},
    {"splat_occlusion", "Share of the pixel lights' light that their shadows let through", "white: all, black: nothing",
     "", "splatting", shared::show_splat_occlusion, true},
    {"rsm", "Texels of the reflective shadow maps, where they lie, by the flux that they reflect",
     "dots: texels; white: the brightest", "", "splatting", shared::show_map_flux, true},
    {"importance", "The same texels by importance: where it is great, pixel lights are dense",
     "dots: texels; white: the greatest, black: none", "", "splatting", shared::show_importance, true}};
constexpr std::size_t most_texels_shown = 8192;

CellSet first_bounces(bool fixed, bool dynamic) {
    CellSet cells;
    for (std::size_t i = 0; i < light_cell_count; ++i)
        if (const LightCell cell = LightCell::at(i);
            cell.path == PathPart::first_bounce && !cell.specular && (cell.dynamic ? dynamic : fixed))
            cells.set(i);
    return cells;
}

CellSet cells_taken(const Settings& settings) {
    const SplatChoice choice = settings.of<SplattingSettings>().splat_lights;
    return first_bounces(choice == SplatChoice::all, choice != SplatChoice::none);
}

SplatRequest request_of(const Settings& settings, CellSet cells, const std::optional<mat4>& view_projection) {
    SplatRequest request;
    request.view_projection = view_projection;
    request.lit = {(cells & first_bounces(true, false)).any(), (cells & first_bounces(false, true)).any()};
    request.sampled = settings.sampled_light == SampledLight::all ? SplatParts{true, true} : request.lit;
    request.movers_are_static = settings.movers == movers_static;
    request.seed = settings.seed;
    request.settings = settings.of<SplattingSettings>();
    return request;
}

} // namespace

const TechniqueEntry& splatting_technique();
const TechniqueEntry& splatting_technique() {
    static const TechniqueEntry entry{
        .name = "splatting",
        .tooltip = "The first bounce of emitters that change every frame, by pixel lights of reflective shadow maps",
        .can_light = first_bounces(true, true),
        .takes = cells_taken,
        .reads_maps = false,
        .lights_pixels = true,
        .settings = settings_of<SplattingSettings>(),
        .counters = technique_counters,
        .views = technique_views,
        .shaders = gpu::sunfleck_gi_splatting_shaders,
        .create = SplattingTechnique::create,
    };
    return entry;
}

Result<std::unique_ptr<Technique>> SplattingTechnique::create(gpu::Device& device, gpu::PipelineStore& pipelines) {
    auto technique = std::make_unique<SplattingTechnique>();
    SUNFLECK_ASSIGN(technique->kernel_, SplatKernel::create(device, pipelines));
    return std::unique_ptr<Technique>(std::move(technique));
}

Status SplattingTechnique::update(const SceneView& scene, Services& services, CellSet cells) {
    const StageTimer timer(services.cpu_times, "pixel lights");
    const Settings& settings = services.settings;
    rows_.clear();
    // Reflected light is switched off, or there is none.
    const bool dark = services.input.indirect_scale <= 0.0f || settings.bounces == 0;
    if (dark) {
        maps_.clear();
        return {};
    }
    const SplatRequest request = request_of(settings, cells, services.input.view_projection);
    lights_.update(scene, services.samples, request);
    const float least = request.settings.splat_cutoff * lights_.mean_irradiance();
    kernel_->set_least(least * services.input.indirect_scale);
    const float clamp_scale = splat_clamp_scale * settings.clamp_scale;
    rows_.reserve(lights_.lights().size());
    const bool ambient = settings.shadows && request.settings.splat_occlusion == SplatOcclusion::ambient;
    for (PixelLight light : lights_.lights()) {
        if (ambient) // before its bound is made, which is what the paper gains by it (table 3)
            light.flux *= 1.0f - ambient_occlusion(make_pixel_light_row(light, 0, clamp_scale, 0.0f),
                                                   request.settings.splat_ambient_reach, scene.rays);
        rows_.push_back(make_pixel_light_row(light, std::uint32_t(rows_.size()), clamp_scale, least));
        rows_.back().row.intensity_slot *= vec4(vec3(services.input.indirect_scale), 1.0f);
    }
    find_occlusion(scene, request.settings, settings.shadows);
    return {};
}

void SplattingTechnique::find_occlusion(const SceneView& scene, const SplattingSettings& settings, bool shadows) {
    if (!shadows || settings.splat_occlusion != SplatOcclusion::maps)
        maps_.clear();
    if (shadows && settings.splat_occlusion == SplatOcclusion::maps)
        maps_.update(rows_, side_of_pixel_light_maps(settings.splat_map_side, rows_.size()), scene.rays,
                     moving_spheres(scene.changes));
}

Status SplattingTechnique::add_passes(gpu::FrameGraph& graph, Services& services, LightTarget& target) {
    // Lobes that end: beams have no bound.
    kernel_->set_blocks(std::ranges::any_of(
        rows_, [](const shared::PixelLightRow& row) { return row.lobe.w > 1.0f && row.extent.y >= 0.0f; }));
    target.bytes_per_group = std::max(target.bytes_per_group, kernel_->bytes_per_group());
    kernel_->set_show(target.view != nullptr ? target.view->code : shared::show_no_splats);
    kernel_->set_lists(services.settings.of<SplattingSettings>().splat_lists);
    kernel_->set_levels(services.settings.of<SplattingSettings>().splat_levels);
    view_rows_.clear();
    if (target.view != nullptr &&
        (target.view->code == shared::show_map_flux || target.view->code == shared::show_importance))
        show_texels(target.view->code == shared::show_importance);
    const bool filtered = services.settings.of<SplattingSettings>().splat_map_filter;
    return kernel_->set_maps(graph, maps_.texels(), maps_.side(), filtered, services.resources);
}

// On a scale from 0 to 1. Square roots, as most texels are far from the greatest.
void SplattingTechnique::show_texels(bool importance) {
    const std::vector<SplatLights::SeenTexel> texels = lights_.texels(most_texels_shown);
    float most = 0.0f;
    for (const SplatLights::SeenTexel& texel : texels)
        most = std::max({most, texel.flux.x, texel.flux.y, texel.flux.z});
    for (const SplatLights::SeenTexel& texel : texels) {
        shared::PixelLightRow row{};
        row.row.position_bound = vec4(texel.position, 0.0f);
        row.row.intensity_slot =
            vec4(importance ? vec3(std::sqrt(texel.importance)) : glm::sqrt(texel.flux / most), 0.0f);
        row.lobe.w = 1.0f;
        row.extent.y = -1.0f;
        view_rows_.push_back(row);
    }
}

Status SplattingTechnique::light_pixels(const PixelStage& stage, Services& services) {
    return kernel_->add_passes(stage, view_rows_.empty() ? rows_ : view_rows_, services.resources);
}

void SplattingTechnique::report(Report& report) const {
    report.set(pixel_lights, double(rows_.size()));
    report.set(reflective_maps, double(lights_.maps()));
    report.set(reflective_rays, double(lights_.rays()));
    report.set(occlusion_rays, double(maps_.rays()));
    report.set(memory, double(lights_.memory_bytes() + kernel_->memory_bytes() + maps_.memory_bytes()));
}

} // namespace sunfleck::gi

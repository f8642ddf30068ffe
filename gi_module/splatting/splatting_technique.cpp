#include "gi_module/splatting/splatting_technique.h"

#include "gi_module/splatting/splat_occlusion.h"

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
                                 "Texels of shadow maps of pixel lights that were made in this frame"};
constexpr Counter memory{"splatting", "B", memory_group, "Reflective shadow maps, pixel lights and lists of tiles"};
constexpr Counter technique_counters[] = {pixel_lights, reflective_maps, reflective_rays, occlusion_rays, memory};

constexpr DebugView technique_views[] = {
    {"splats", "Where the pixel lights are, in their colours", "dots: pixel lights", "", "splatting",
     shared::show_splat_places, true},
    {"overdraw", "Pixel lights that are evaluated for a pixel", "white: 256", "", "splatting", shared::show_overdraw,
     true},
    {"splat_occlusion", "Share of the pixel lights' light that their shadows let through", "white: all, black: nothing",
     "", "splatting", shared::show_splat_occlusion, true}};

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

SplatRequest request_of(const Settings& settings, CellSet cells) {
    SplatRequest request;
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
    map_texels_.clear();
    // Reflected light is switched off, or there is none.
    const bool dark = services.input.indirect_scale <= 0.0f || settings.bounces == 0;
    if (dark)
        return {};
    const SplatRequest request = request_of(settings, cells);
    lights_.update(scene, services.samples, request);
    const float least = request.settings.splat_cutoff * lights_.mean_irradiance();
    const float clamp_scale = splat_clamp_scale * settings.clamp_scale;
    rows_.reserve(lights_.lights().size());
    for (const PixelLight& light : lights_.lights()) {
        rows_.push_back(make_pixel_light_row(light, std::uint32_t(rows_.size()), clamp_scale, least));
        rows_.back().row.intensity_slot *= vec4(vec3(services.input.indirect_scale), 1.0f);
    }
    if (settings.shadows)
        find_occlusion(scene, request.settings);
    return {};
}

void SplattingTechnique::find_occlusion(const SceneView& scene, const SplattingSettings& settings) {
    if (settings.splat_occlusion == SplatOcclusion::ambient)
        for (shared::PixelLightRow& row : rows_)
            row.row.intensity_slot *=
                vec4(vec3(1.0f - ambient_occlusion(row, settings.splat_ambient_reach, scene.rays)), 1.0f);
    if (settings.splat_occlusion != SplatOcclusion::maps)
        return;
    map_side_ = side_of_pixel_light_maps(settings.splat_map_side, rows_.size());
    trace_pixel_light_maps(rows_, map_side_, scene.rays, map_texels_);
}

Status SplattingTechnique::add_passes(gpu::FrameGraph& graph, Services& services, LightTarget& target) {
    target.bytes_per_group = std::max(target.bytes_per_group, SplatKernel::bytes_per_group);
    kernel_->set_show(target.view != nullptr ? target.view->code : shared::show_no_splats);
    const bool filtered = services.settings.of<SplattingSettings>().splat_map_filter;
    return kernel_->set_maps(graph, map_texels_, map_side_, filtered, services.resources);
}

Status SplattingTechnique::light_pixels(const PixelStage& stage, Services& services) {
    return kernel_->add_passes(stage, rows_, services.resources);
}

void SplattingTechnique::report(Report& report) const {
    report.set(pixel_lights, double(rows_.size()));
    report.set(reflective_maps, double(lights_.maps()));
    report.set(reflective_rays, double(lights_.rays()));
    report.set(occlusion_rays, double(map_texels_.size()));
    report.set(memory, double(lights_.memory_bytes() + kernel_->memory_bytes() +
                              map_texels_.capacity() * sizeof(std::uint16_t)));
}

} // namespace sunfleck::gi

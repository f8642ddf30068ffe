#include "gi_module/many_light/many_light_technique.h"

#include "gi_module/shadows/light_batches.h"

namespace sunfleck::gpu {
std::span<const EmbeddedShader> sunfleck_gi_many_light_shaders();
}

namespace sunfleck::gi {
namespace {

constexpr std::uint64_t max_curved_points = std::uint64_t(1) << 20; // of baked light: 56 MiB

constexpr Counter map_updates{"light_map_updates", "contributions", "light maps",
                              "Contributions of single samples added to or subtracted from light maps in this frame"};
constexpr Counter maps_waiting{"light_maps_waiting", "jobs", "light maps",
                               "Parts of light maps that later frames sum; until then, no light map is used"};
constexpr Counter map_texels{"light_map_texels", "texels", "light maps", "Texels of all light maps"};
constexpr Counter baked_updates{"baked_light_updates", "contributions", "light maps",
                                "Contributions of single samples to baked light in this frame"};
constexpr Counter baked_waiting{"baked_light_waiting", "patches", "light maps",
                                "Patches and charts whose light is not baked yet"};
constexpr Counter refined_waiting{"refined_light_waiting", "samples", "light maps",
                                  "Samples by which light is still to be refined (baked_samples)"};
constexpr Counter refined_changes{"refined_light_changes", "frames", "light maps",
                                  "1 in a frame in which what is shown takes over refined light"};
constexpr Counter render_passes{"render_passes", "passes", "render passes",
                                "Render passes that a renderer with a few lights a pass would need, merged"};
constexpr Counter render_passes_alone{"render_passes_unoptimised", "passes", "render passes",
                                      "The same with every object drawn by itself"};
constexpr Counter pass_fill{"pass_fill", "", "render passes",
                            "Pairs of object and light drawn in those passes, over those needed"};
constexpr Counter memory{"many_light", "B", memory_group, "Lists, sums, light maps, baked light and tables on the GPU"};
constexpr Counter technique_counters[] = {map_updates,         maps_waiting,    map_texels,      baked_updates,
                                          baked_waiting,       refined_waiting, refined_changes, render_passes,
                                          render_passes_alone, pass_fill,       memory};

constexpr std::string_view samples_legend = "share of all samples: cyan none, green a quarter, yellow half, red all";
constexpr DebugView technique_views[] = {
    {"tiles", "Length of each tile's lists of light samples",
     "red: samples with a shadow test, green: samples without, as shares of all", "", "many-light", shared::show_tiles},
    {"repaired", "Pixels that are lit again at full resolution", "pink: lit again", "", "many-light",
     shared::show_repaired},
    {"visibility", "What the visibility database knows of each surface patch",
     "red: samples that are partly blocked, green: free, blue: fully blocked", "", "many-light",
     shared::show_visibility, true},
    {"staleness", "Age of the shadow maps that a surface needs", "cyan: up to date, red: eight frames old", "frames",
     "many-light", shared::show_staleness, true},
    {"light_maps", "Unshadowed light in light maps", "irradiance", "W/m2", "many-light", shared::show_light_maps, true},
    {"baked", "Where light is baked", "green: baked, with blue where movers change it; red: lit by all samples", "",
     "many-light", shared::show_baked, true},
    {"patches", "Surface patches of the visibility database, and movers", "a colour for each", "", "visibility",
     shared::show_patches, true},
    {"lighting_samples", "Light samples that a patch may see at all", samples_legend, "", "visibility",
     shared::show_lighting, true},
    {"hidden_samples", "Light samples that are fully blocked: they cost a patch nothing", samples_legend, "",
     "visibility", shared::show_hidden, true},
    {"shadow_tests", "Light samples that need a shadow test: what a patch costs", samples_legend, "", "visibility",
     shared::show_shadow_tests, true},
    {"static_shadows", "Light samples that what stands still may shadow: baked light holds these shadows",
     samples_legend, "", "visibility", shared::show_static_shadows, true},
    {"mover_shadows", "Light samples that movers may shadow: what is left to do where light is baked", samples_legend,
     "", "visibility", shared::show_mover_shadows, true}};

} // namespace

const TechniqueEntry& many_light_technique();
const TechniqueEntry& many_light_technique() {
    static const TechniqueEntry entry{
        .name = "light_samples",
        .tooltip =
            "The many-light system: light samples with shadow maps, tested only where something may be in the way",
        .can_light = all_diffuse_cells(),
        .wants_visibility = true,
        .lights_pixels = true,
        .settings = settings_of<ManyLightSettings>(),
        .counters = technique_counters,
        .views = technique_views,
        .shaders = gpu::sunfleck_gi_many_light_shaders,
        .create = ManyLightTechnique::create,
    };
    return entry;
}

Result<std::unique_ptr<Technique>> ManyLightTechnique::create(gpu::Device& device, gpu::PipelineStore& pipelines) {
    auto technique = std::make_unique<ManyLightTechnique>();
    SUNFLECK_ASSIGN(technique->lighting_, ManyLight::create(device, pipelines));
    return std::unique_ptr<Technique>(std::move(technique));
}

// Light can only be baked when the static part of every held sample's map is there: a host may have the first maps
// drawn over many frames (FrameInput::map_budget).
void ManyLightTechnique::find_static_maps(const Services& services, ManyLightOptions& options) const {
    const ShadowService& shadows = services.shadows;
    const auto waits = [&](std::uint32_t sample) {
        return shadows.is_static_stale(sample) && held_by_light_maps(services.samples.samples()[sample]);
    };
    std::size_t waiting = 0, drawn = 0;
    for (std::uint32_t sample = 0; sample < services.samples.size(); ++sample)
        waiting += waits(sample);
    for (const std::uint32_t sample : shadows.to_draw())
        drawn += waits(sample);
    options.baked_light = options.baked_light && services.settings.static_maps && waiting == drawn &&
                          shadows.maps().slots() >= services.samples.size();
    options.static_maps_changed = drawn > 0;
    options.bake_in_portions = services.input.map_budget != FrameInput().map_budget;
}

Status ManyLightTechnique::update(const SceneView& scene, Services& services, CellSet cells) {
    const StageTimer timer(services.cpu_times, "light lists");
    const Settings& settings = services.settings;
    const ManyLightSettings& own = settings.of<ManyLightSettings>();
    const SampleSet& samples = services.samples;
    if (services.restart)
        lighting_->restart();
    cells_ = cells;
    options_ = {};
    options_.shadows = settings.shadows;
    options_.filter = settings.shadow_filter;
    options_.visibility = own.visibility;
    options_.light_maps = own.light_maps && own.visibility;
    options_.baked_light = own.baked_light;
    options_.refinement_budget = services.input.refinement_budget;
    find_static_maps(services, options_);
    VisibilityDatabase& database = *services.visibility;
    if (own.baked_light && curved_generation_ != database.generation()) {
        curved_charts_.build(scene.registry, scene.meshes, database.patches(),
                             light_map_texel(samples.geometry_bound()), max_curved_points);
        curved_generation_ = database.generation();
    }
    SUNFLECK_TRY(
        lighting_->update({database, curved_charts_, scene.gpu_scene, samples.samples(),
                           owned_rows(samples, cells, owned_rows_), samples.late_changes() > 0},
                          {database, samples, curved_charts_, cells, scene.rays, settings, scene.gpu_scene.bounds()},
                          options_, services.resources));
    if (own.count_passes && services.input.view_projection)
        passes_.count(database, *services.input.view_projection, own);
    else
        passes_.forget();
    return {};
}

Status ManyLightTechnique::add_passes(gpu::FrameGraph& graph, Services& services, LightTarget& target) {
    const SampleSet& samples = services.samples;
    SUNFLECK_ASSIGN(const std::vector<LightBatch> batches,
                    make_light_batches(samples, services.shadows, cells_, 0, samples.size(), services.resources));
    batches_ = batches.size();
    options_.show = target.view != nullptr ? target.view->code : shared::show_nothing;
    options_.simplified_movers = services.shadows.simplifies_movers();
    options_.stale_maps = services.maps_are_stale();
    SUNFLECK_TRY(lighting_->add_passes(graph, {services.shadows.maps(), batches, services.shadows.ages()}, options_,
                                       services.resources));
    target.bytes_per_group = lighting_->bytes_per_group();
    return {};
}

Status ManyLightTechnique::light_pixels(const PixelStage& stage, Services& services) {
    return lighting_->light(stage, services.resources);
}

void ManyLightTechnique::report(Report& report) const {
    report.add(light_batch_counter, double(batches_));
    report.set(map_updates, double(lighting_->light_maps().counters().updates));
    report.set(maps_waiting, double(lighting_->light_maps().counters().waiting));
    report.set(map_texels, double(lighting_->light_maps().counters().texels));
    report.set(baked_updates, double(lighting_->baked_light().counters().updates));
    report.set(baked_waiting, double(lighting_->baked_light().counters().waiting));
    report.set(refined_waiting, double(lighting_->refinement_waiting()));
    report.set(refined_changes, lighting_->refinement_shows() ? 1.0 : 0.0);
    report.set(memory, double(lighting_->memory_bytes()));
    const PassGrouping* passes = passes_.passes();
    report.set(pass_fill, passes != nullptr ? passes->fill() : 1.0);
    if (passes == nullptr)
        return;
    report.set(render_passes, double(passes->passes()));
    report.set(render_passes_alone, double(passes->passes_unoptimised()));
}

} // namespace sunfleck::gi

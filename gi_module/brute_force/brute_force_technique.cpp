#include "gi_module/brute_force/brute_force_technique.h"

#include "gi_module/shadows/light_batches.h"

namespace sunfleck::gpu {
std::span<const EmbeddedShader> sunfleck_gi_brute_force_shaders();
}

namespace sunfleck::gi {
namespace {

constexpr Counter clamped_flux{"clamped_flux", "W", "clamping",
                               "Light over the visible surface that the bound of the geometry term removed, luminance; "
                               "with count_clamped",
                               true};
constexpr Counter clamped_irradiance{"clamped_irradiance", "W/m2", "clamping", "The same, mean over pixels", true};
constexpr Counter technique_counters[] = {clamped_flux, clamped_irradiance};

} // namespace

const TypeDescription& BruteForceSettings::description() {
    static const TypeDescription type{
        "BruteForceSettings",
        1,
        "The baseline.",
        {SUNFLECK_FIELD(BruteForceSettings, count_clamped, "", 0, 1,
                        "Measures the light that the bound of the geometry term removes (brute_force only)"),
         SUNFLECK_FIELD(BruteForceSettings, kernel_pixels, "", 0, 16,
                        "Pixels that an invocation of the kernel lights; 0: what is fastest on the device")
             .only({0, 1, 2, 4, 8, 16}),
         SUNFLECK_CHOICE(BruteForceSettings, kernel_lights, "Kind of buffer from which the kernel reads lights",
                         "standard", "uniform", "storage"),
         SUNFLECK_CHOICE(BruteForceSettings, kernel_maps, "Kind of buffer from which the kernel reads shadow maps",
                         "standard", "texel", "storage")}};
    return type;
}

const TechniqueEntry& brute_force_technique();
const TechniqueEntry& brute_force_technique() {
    static const TechniqueEntry entry{
        .name = "brute_force",
        .tooltip = "The baseline: every light sample with its shadow map at every pixel",
        .can_light = all_diffuse_cells(),
        .needs_full_maps = true,
        .settings = settings_of<BruteForceSettings>(),
        .counters = technique_counters,
        .shaders = gpu::sunfleck_gi_brute_force_shaders,
        .create = BruteForceTechnique::create,
    };
    return entry;
}

namespace {

KernelShape shape_of(const BruteForceSettings& settings, KernelShape shape) {
    if (settings.kernel_pixels != 0)
        shape.pixels = settings.kernel_pixels;
    if (settings.kernel_lights != KernelLights::standard)
        shape.storage_lights = settings.kernel_lights == KernelLights::storage;
    if (settings.kernel_maps != KernelMaps::standard)
        shape.maps =
            settings.kernel_maps == KernelMaps::texel ? shared::maps_texel_buffer : shared::maps_storage_buffer;
    return shape;
}

} // namespace

Result<std::unique_ptr<Technique>> BruteForceTechnique::create(gpu::Device& device, gpu::PipelineStore& pipelines) {
    auto technique = std::make_unique<BruteForceTechnique>();
    SUNFLECK_ASSIGN(technique->kernel_, BruteForce::create(device, pipelines));
    technique->standard_shape_ = BruteForce::default_shape(device.traits());
    return std::unique_ptr<Technique>(std::move(technique));
}

Status BruteForceTechnique::update(const SceneView& scene, Services& services, CellSet cells) {
    if (services.input.previous_frame_lost)
        kernel_->drop_last_counts();
    cells_ = cells;
    unit_ = scene.changes.space.unit;
    batches_ = 0;
    return {};
}

// With more samples than shadow maps, groups of samples take turns: their maps are drawn, used and overwritten.
Status BruteForceTechnique::add_passes(gpu::FrameGraph& graph, Services& services, LightTarget& target) {
    const SampleSet& samples = services.samples;
    ShadowService& shadows = services.shadows;
    const std::uint32_t total = samples.size();
    const bool shared_slots = shadows.slots_are_shared(total);
    const std::uint32_t at_once = shared_slots ? shadows.slots() : std::max(total, 1u);
    BruteForceOptions options;
    options.shadows = services.settings.shadows;
    options.filter = services.settings.shadow_filter;
    options.count_clamped = services.settings.of<BruteForceSettings>().count_clamped;
    kernel_->set_shape(shape_of(services.settings.of<BruteForceSettings>(), standard_shape_));
    for (std::uint32_t first = 0; first == 0 || first < total; first += at_once) {
        const std::uint32_t count = std::min(at_once, total - first);
        if (shared_slots)
            SUNFLECK_TRY(shadows.add_map_range(graph, target.gpu_scene, samples, first, count, services.resources));
        SUNFLECK_ASSIGN(const std::vector<LightBatch> batches,
                        make_light_batches(samples, shadows, cells_, first, count, services.resources));
        batches_ += batches.size();
        if (first == 0)
            SUNFLECK_TRY(kernel_->begin_frame(target.g_buffer.width, target.g_buffer.height,
                                              shared_slots || batches.size() > 1, services.input.serial,
                                              services.input.completed_serial, services.resources));
        SUNFLECK_TRY(kernel_->add_pass({graph, target.g_buffer, target.camera, shadows.maps(), target.irradiance},
                                       batches, options, first == 0, first + count == total));
    }
    return {};
}

void BruteForceTechnique::report(Report& report) const {
    report.add(light_batch_counter, double(batches_));
    report.set(clamped_flux, kernel_->clamped().flux * double(unit_) * double(unit_));
    report.set(clamped_irradiance, kernel_->clamped().mean_irradiance);
}

} // namespace sunfleck::gi

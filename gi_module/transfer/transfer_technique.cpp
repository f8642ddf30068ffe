#include "gi_module/transfer/transfer_technique.h"

#include "gi_module/shadows/light_batches.h"

namespace sunfleck::gpu {
std::span<const EmbeddedShader> sunfleck_gi_transfer_shaders();
}

namespace sunfleck::gi {
namespace {

constexpr Counter vertices{"transfer_vertices", "vertices", "precomputed transfer",
                           "Vertices of movers that are lit by precomputed transfer"};
constexpr Counter memory{"precomputed_transfer", "B", memory_group, "Precomputed transfer of all meshes, on the CPU"};
constexpr Counter technique_counters[] = {vertices, memory};

bool supports(const scene::DrawItem& mover, const ecs::Registry& registry, const scene::MeshStore& meshes) {
    return TransferLighting::supports(mover, registry.get<scene::WorldTransform>(mover.entity).matrix, meshes,
                                      registry.get<scene::MeshInstance>(mover.entity).mesh);
}

} // namespace

const TypeDescription& TransferSettings::description() {
    static const TypeDescription type{
        "TransferSettings",
        1,
        "Precomputed radiance transfer for movers.",
        {SUNFLECK_FIELD(TransferSettings, transfer_points, "", 1, 6,
                        "With movers prt: points along each axis of a mover where its incident light is computed; more "
                        "for sharper shadows on it"),
         SUNFLECK_FIELD(TransferSettings, transfer_reflections, "", 0, 2,
                        "With movers prt: how often light is reflected from a mover onto itself")}};
    return type;
}

const TechniqueEntry& transfer_technique();
const TechniqueEntry& transfer_technique() {
    static const TechniqueEntry entry{
        .name = "prt",
        .tooltip =
            "Precomputed radiance transfer: rigid, opaque movers of 128 triangles or more, lit at their vertices",
        .can_light = cells_where([](LightCell cell) { return cell.on_mover && !cell.specular; }),
        .supports = supports,
        .settings = settings_of<TransferSettings>(),
        .counters = technique_counters,
        .shaders = gpu::sunfleck_gi_transfer_shaders,
        .create = TransferTechnique::create,
    };
    return entry;
}

Result<std::unique_ptr<Technique>> TransferTechnique::create(gpu::Device& device, gpu::PipelineStore& pipelines) {
    auto technique = std::make_unique<TransferTechnique>();
    SUNFLECK_ASSIGN(technique->pass_, TransferPass::create(device, pipelines));
    return std::unique_ptr<Technique>(std::move(technique));
}

Status TransferTechnique::update(const SceneView& scene, Services& services, CellSet cells) {
    const StageTimer timer(services.cpu_times, "transfer");
    const TransferSettings& own = services.settings.of<TransferSettings>();
    TransferLightingOptions options;
    options.points = own.transfer_points;
    options.reflections = own.transfer_reflections;
    options.cache = services.cache_folder;
    options.progress = services.input.progress;
    const ProbeScene probe{scene.rays,
                           services.samples.samples(),
                           owned_rows(services.samples, cells, owned_rows_),
                           scene.gpu_scene.draws(),
                           services.visibility,
                           scene.changes.space};
    lighting_.clear();
    return lighting_.update(scene.registry, scene.meshes, probe, options, services.resources);
}

Status TransferTechnique::add_passes(gpu::FrameGraph& graph, Services&, LightTarget& target) {
    pass_->add_passes(graph, lighting_.draws(), target);
    return {};
}

void TransferTechnique::report(Report& report) const {
    report.set(vertices, double(lighting_.vertices()));
    report.set(memory, double(lighting_.memory_bytes()));
}

} // namespace sunfleck::gi

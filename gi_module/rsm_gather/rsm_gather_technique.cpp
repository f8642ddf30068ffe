#include "gi_module/rsm_gather/rsm_gather_technique.h"

#include <algorithm>
#include <cstring>

namespace sunfleck::gpu {
std::span<const EmbeddedShader> sunfleck_gi_rsm_gather_shaders();
}

namespace sunfleck::gi {
namespace {

constexpr Counter gathered_maps{"gathered_maps", "maps", "rsm_gather",
                                "Reflective shadow maps that light is gathered from"};
constexpr Counter map_rays{"gathered_map_rays", "rays", "rsm_gather",
                           "Texels of those maps that were made in this frame"};
constexpr Counter samples_counter{"gathered_texels", "texels", "rsm_gather", "Texels that a pixel looks up"};
constexpr Counter memory{"rsm_gather", "B", memory_group, "Reflective shadow maps that light is gathered from"};
constexpr Counter technique_counters[] = {gathered_maps, map_rays, samples_counter, memory};

CellSet first_bounces(bool fixed, bool dynamic) {
    return cells_where([&](const LightCell& cell) {
        return cell.path == PathPart::first_bounce && !cell.specular && (cell.dynamic ? dynamic : fixed);
    });
}

CellSet cells_taken(const Settings& settings) {
    const GatherChoice choice = settings.of<RsmGatherSettings>().gather_lights;
    return first_bounces(choice == GatherChoice::all, choice != GatherChoice::none);
}

GatherRequest request_of(const Settings& settings, CellSet cells) {
    GatherRequest request;
    request.lit = {(cells & first_bounces(true, false)).any(), (cells & first_bounces(false, true)).any()};
    request.sampled = settings.sampled_light == SampledLight::all ? GatheredParts{true, true} : request.lit;
    request.movers_are_static = settings.movers == movers_static;
    request.seed = settings.seed;
    request.clamp_scale = splat_clamp_scale * settings.clamp_scale;
    request.settings = settings.of<RsmGatherSettings>();
    return request;
}

} // namespace

const TechniqueEntry& rsm_gather_technique();
const TechniqueEntry& rsm_gather_technique() {
    static const TechniqueEntry entry{
        .name = "rsm_gather",
        .tooltip = "The baseline of splatting: the first bounce, gathered from reflective shadow maps, unshadowed",
        .can_light = first_bounces(true, true),
        .takes = cells_taken,
        .reads_maps = false,
        .lights_pixels = true,
        .settings = settings_of<RsmGatherSettings>(),
        .counters = technique_counters,
        .shaders = gpu::sunfleck_gi_rsm_gather_shaders,
        .create = RsmGatherTechnique::create,
    };
    return entry;
}

Result<std::unique_ptr<Technique>> RsmGatherTechnique::create(gpu::Device& device, gpu::PipelineStore& pipelines) {
    std::unique_ptr<RsmGatherTechnique> technique(new RsmGatherTechnique(device, pipelines));
    const VkSamplerCreateInfo sampler{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
    SUNFLECK_VK(device.vk.vkCreateSampler(device.handle(), &sampler, nullptr, &technique->sampler_),
                "creating a sampler");
    return std::unique_ptr<Technique>(std::move(technique));
}

RsmGatherTechnique::~RsmGatherTechnique() {
    device_.vk.vkDestroySampler(device_.handle(), sampler_, nullptr);
}

Status RsmGatherTechnique::update(const SceneView& scene, Services& services, CellSet cells) {
    const StageTimer timer(services.cpu_times, "gathered maps");
    scale_ = services.input.indirect_scale;
    if (services.restart)
        uploaded_ = 0;
    // Reflected light is switched off, or there is none.
    if (scale_ <= 0.0f || services.settings.bounces == 0)
        maps_.clear();
    else
        maps_.update(scene, services.samples, request_of(services.settings, cells));
    return {};
}

Status RsmGatherTechnique::add_passes(gpu::FrameGraph& graph, Services& services, LightTarget&) {
    return maps_.rows().empty() ? Status() : upload(graph, services);
}

Status RsmGatherTechnique::upload(gpu::FrameGraph& graph, Services& services) {
    gpu::FrameResources& resources = services.resources;
    const auto places = std::as_bytes(maps_.places()), lights = std::as_bytes(maps_.lights()),
               pattern = std::as_bytes(maps_.pattern());
    SUNFLECK_ASSIGN(pattern_, resources.allocate(std::max<std::size_t>(pattern.size(), sizeof(shared::GatherSample))));
    std::memcpy(pattern_.data, pattern.data(), pattern.size());
    if (uploaded_ == maps_.version())
        return {};
    places_.forget_pieces();
    lights_.forget_pieces();
    SUNFLECK_TRY(
        places_.reserve(device_, resources, "places of gathered light", places.size(), VK_FORMAT_R32G32B32A32_UINT));
    SUNFLECK_TRY(lights_.reserve(device_, resources, "gathered light", lights.size(), VK_FORMAT_R32G32_UINT));
    SUNFLECK_TRY(places_.write(resources, 0, places));
    SUNFLECK_TRY(lights_.write(resources, 0, lights));
    places_.add_pass(graph);
    lights_.add_pass(graph);
    uploaded_ = maps_.version();
    return {};
}

Status RsmGatherTechnique::light_pixels(const PixelStage& stage, Services& services) {
    if (stage.first)
        SUNFLECK_TRY(stage.low_resolution.list_pixels(stage));
    const bool writes_picture = stage.last && stage.resolves;
    const std::span<const shared::GatherMapRow> rows = maps_.rows();
    if (rows.empty())
        return writes_picture ? stage.low_resolution.resolve(stage) : Status();
    for (std::size_t first = 0; first < rows.size(); first += shared::gather_maps_per_batch) {
        const std::size_t count = std::min<std::size_t>(shared::gather_maps_per_batch, rows.size() - first);
        SUNFLECK_TRY(add_batch(stage, rows.subspan(first, count), writes_picture && first + count == rows.size(),
                               services.resources));
    }
    return {};
}

Status RsmGatherTechnique::add_batch(const PixelStage& stage, std::span<const shared::GatherMapRow> rows, bool to_image,
                                     gpu::FrameResources& resources) {
    SUNFLECK_ASSIGN(const gpu::UploadSlice maps,
                    resources.allocate(sizeof(shared::GatherMapRow) * shared::gather_maps_per_batch));
    std::memcpy(maps.data, rows.data(), rows.size_bytes());
    const std::uint32_t lanes = device_.traits().software ? 8 : 64;
    gpu::ComputeDescription description;
    description.shader = "gi_module/rsm_gather/rsm_gather.comp";
    description.specialization = {shared::pixel_group_size / lanes, lanes, to_image};
    SUNFLECK_ASSIGN(const gpu::Pipeline* kernel, pipelines_.compute(description));
    gpu::ComputePass pass(stage.graph, stage.repair ? "repair gathered light" : "gathered light", *kernel);
    pass.uniform(stage.camera)
        .sampled(stage.g_buffer.depth, sampler_)
        .sampled(stage.g_buffer.normals, sampler_)
        .uniform(maps)
        .storage_read(pattern_)
        .storage_read(stage.pixels)
        .storage_read_write(stage.sums)
        .storage_write(stage.output)
        .texels(places_.buffer())
        .texels(lights_.buffer())
        .push(shared::GatherConstants{std::uint32_t(rows.size()), scale_});
    stage.dispatch(pass, shared::command_groups);
    return {};
}

void RsmGatherTechnique::report(Report& report) const {
    report.set(gathered_maps, double(maps_.rows().size()));
    report.set(map_rays, double(maps_.rays()));
    report.set(samples_counter, double(maps_.rows().empty() ? 0 : maps_.pattern().size()));
    report.set(memory, double(maps_.memory_bytes() + places_.buffer().size() + lights_.buffer().size()));
}

} // namespace sunfleck::gi

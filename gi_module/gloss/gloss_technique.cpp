#include "gi_module/gloss/gloss_technique.h"

#include "engine/core/divide_up.h"
#include "engine/gpu/compute_pass.h"
#include "gi_module/gloss/gloss_lights.h"
#include "gi_module/gloss/gloss_settings.h"
#include "gi_module/gloss/gloss_shared.h"
#include "gi_module/shadows/light_batches.h"
#include "gi_module/shadows/octahedral_map.h"
#include "gi_module/transport/reflectance.h"

namespace sunfleck::gpu {
std::span<const EmbeddedShader> sunfleck_gi_gloss_shaders();
}

namespace sunfleck::gi {
namespace {

constexpr Counter glossy_pixels{"glossy_pixels", "pixels", "gloss",
                                "Pixels of the rectangle that contains all glossy surfaces"};
constexpr Counter technique_counters[] = {glossy_pixels};

// Of samples of reflected light, so that at most so many are left.
std::uint32_t stride_of(const SampleSet& samples, std::uint32_t most) {
    std::uint32_t reflected = 0;
    for (const LightSample& sample : samples.samples())
        reflected += sample.bounce > 0 ? 1 : 0;
    return most > 0 ? std::max(divide_up(reflected, most), 1u) : 1u;
}

} // namespace

const TypeDescription& GlossSettings::description() {
    static const TypeDescription type{
        "GlossSettings",
        1,
        "Glossy light.",
        {SUNFLECK_FIELD(GlossSettings, gloss_samples, "", 0, 100000,
                        "Samples of reflected light that glossy surfaces reflect, each for its neighbours; 0: all")}};
    return type;
}

const TechniqueEntry& gloss_technique();
const TechniqueEntry& gloss_technique() {
    static const TechniqueEntry entry{
        .name = "gloss",
        .tooltip = "Metals and coats by microfacets, lit by the same light samples as all else; no mirrors",
        .can_light = ~all_diffuse_cells(),
        .lights_specular = true,
        .settings = settings_of<GlossSettings>(),
        .counters = technique_counters,
        .shaders = gpu::sunfleck_gi_gloss_shaders,
        .create = GlossTechnique::create,
    };
    return entry;
}

// What the dispatches of a frame share.
struct GlossTechnique::Pass {
    gpu::FrameGraph& graph;
    const Services& services;
    const LightTarget& target;
    gpu::UploadSlice table;
};

Result<std::unique_ptr<Technique>> GlossTechnique::create(gpu::Device& device, gpu::PipelineStore& pipelines) {
    std::unique_ptr<GlossTechnique> technique(new GlossTechnique(device, pipelines));
    const VkSamplerCreateInfo sampler{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
    SUNFLECK_VK(device.vk.vkCreateSampler(device.handle(), &sampler, nullptr, &technique->sampler_),
                "creating a sampler");
    // Some drivers need every binding of a set to be alive, used or not.
    gpu::BufferDescription unused;
    unused.name = "unused texels";
    unused.usage = VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT;
    unused.texel_format = VK_FORMAT_R32_UINT;
    SUNFLECK_ASSIGN(technique->no_texels_, gpu::Buffer::create(device, unused));
    return std::unique_ptr<Technique>(std::move(technique));
}

GlossTechnique::~GlossTechnique() {
    device_.vk.vkDestroySampler(device_.handle(), sampler_, nullptr);
}

Status GlossTechnique::update(const SceneView&, Services&, CellSet cells) {
    cells_ = cells;
    return {};
}

Status GlossTechnique::grow_sums(std::uint64_t pixels, gpu::FrameResources& resources) {
    const VkDeviceSize bytes = std::max<VkDeviceSize>(pixels, 1) * sizeof(vec4);
    if (sums_ && sums_.size() >= bytes)
        return {};
    if (sums_)
        resources.retire(std::move(sums_));
    SUNFLECK_ASSIGN(sums_,
                    gpu::Buffer::create(device_, {"sums of glossy light", bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                                                  gpu::MemoryUse::device, VK_FORMAT_UNDEFINED}));
    return {};
}

Result<const gpu::Pipeline*> GlossTechnique::kernel(const LightBatch& batch, const Services& services,
                                                    const GBufferInput& g_buffer) const {
    const bool shadows = services.settings.shadows;
    gpu::ComputeDescription description;
    description.shader = "gi_module/gloss/gloss.comp";
    description.name = "gloss";
    description.specialization = {batch.light_class,
                                  shadows ? shared::maps_texel_buffer : shared::maps_none,
                                  filters_maps(services.settings.shadow_filter, batch.light_class),
                                  services.shadows.maps().bits(),
                                  services.maps_are_stale(),
                                  services.shadows.simplifies_movers(),
                                  g_buffer.base_colour.valid(),
                                  g_buffer.metallic_roughness.valid()};
    return pipelines_.compute(description);
}

// As for brute_force: with more samples than shadow maps, groups of samples take turns.
Status GlossTechnique::add_passes(gpu::FrameGraph& graph, Services& services, LightTarget& target) {
    std::vector<Bounds> glossy;
    for (const scene::DrawItem& item : target.gpu_scene.draws())
        if ((item.constants.surface & shared::surface_glossy) != 0)
            glossy.push_back(item.bounds);
    area_ = covered_pixels(glossy, target.camera, target.g_buffer.width, target.g_buffer.height);
    target.area = area_;
    if (area_.width == 0 || area_.height == 0)
        return {};
    const SampleSet& samples = services.samples;
    ShadowService& shadows = services.shadows;
    const std::uint32_t total = samples.size();
    const bool shared_slots = shadows.slots_are_shared(total);
    const std::uint32_t at_once = shared_slots ? shadows.slots() : std::max(total, 1u);
    const std::vector<float> sizes = sizes_of_samples(samples);
    const std::uint32_t stride = stride_of(samples, services.settings.of<GlossSettings>().gloss_samples);
    SUNFLECK_ASSIGN(const gpu::UploadSlice table, services.resources.upload(facet_table()));
    const Pass pass{graph, services, target, table};
    for (std::uint32_t first = 0; first == 0 || first < total; first += at_once) {
        const std::uint32_t count = std::min(at_once, total - first);
        if (shared_slots)
            SUNFLECK_TRY(shadows.add_map_range(graph, target.gpu_scene, samples, first, count, services.resources));
        SUNFLECK_ASSIGN(std::vector<LightBatch> batches,
                        make_light_batches(samples, shadows, cells_, first, count, services.resources));
        if (first == 0)
            SUNFLECK_TRY(grow_sums(shared_slots || batches.size() > 1 ? std::uint64_t(area_.width) * area_.height : 0,
                                   services.resources));
        for (LightBatch& batch : batches) {
            write_sizes(samples, sizes, batch);
            if (stride > 1)
                thin_out(samples, stride, batch);
        }
        SUNFLECK_TRY(add_batches(pass, batches, first == 0, first + count == total));
    }
    return {};
}

Status GlossTechnique::add_batches(const Pass& pass, std::span<const LightBatch> batches, bool first, bool last) {
    const GBufferInput& g_buffer = pass.target.g_buffer;
    const ShadowMaps& maps = pass.services.shadows.maps();
    for (std::size_t i = 0; i < batches.size(); ++i) {
        SUNFLECK_ASSIGN(const gpu::Pipeline* kernel, this->kernel(batches[i], pass.services, g_buffer));
        const shared::GlossConstants constants{area_.x,
                                               area_.y,
                                               area_.width,
                                               area_.height,
                                               batches[i].count,
                                               maps.resolution(),
                                               first && i == 0 ? 1u : 0u,
                                               last && i + 1 == batches.size() ? 1u : 0u};
        gpu::ComputePass(pass.graph, "gloss", *kernel)
            .uniform(pass.target.camera)
            .sampled(g_buffer.depth, sampler_)
            .sampled(g_buffer.normals, sampler_)
            .sampled(g_buffer.surface, sampler_)
            .sampled(g_buffer.base_colour.valid() ? g_buffer.base_colour : g_buffer.depth, sampler_)
            .sampled(g_buffer.metallic_roughness.valid() ? g_buffer.metallic_roughness : g_buffer.depth, sampler_)
            .sampled(pass.target.irradiance, sampler_)
            .storage_read(pass.target.gpu_scene.rows())
            .uniform(batches[i].rows)
            .storage_read(pass.table)
            .texels(maps.texels() ? maps.texels() : no_texels_)
            .storage_read_write(sums_)
            .storage_write(pass.target.specular)
            .push(constants)
            .dispatch(divide_up(area_.width, 8), divide_up(area_.height, 8));
    }
    return {};
}

void GlossTechnique::report(Report& report) const {
    report.set(glossy_pixels, double(area_.width) * area_.height);
}

} // namespace sunfleck::gi

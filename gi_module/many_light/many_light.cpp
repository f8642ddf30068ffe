#include "engine/core/divide_up.h"
#include "gi_module/many_light/many_light_frame.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace sunfleck::gi {
Result<std::unique_ptr<ManyLight>> ManyLight::create(gpu::Device& device, gpu::PipelineStore& pipelines) {
    std::unique_ptr<ManyLight> technique(new ManyLight(device, pipelines));
    SUNFLECK_ASSIGN(technique->light_maps_, LightMaps::create(device, pipelines));
    SUNFLECK_ASSIGN(technique->baked_light_, BakedLight::create(device, pipelines));
    SUNFLECK_ASSIGN(technique->refined_light_, RefinedLight::create(device, pipelines));
    VkSamplerCreateInfo sampler{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
    SUNFLECK_VK(device.vk.vkCreateSampler(device.handle(), &sampler, nullptr, &technique->sampler_),
                "creating a sampler");
    gpu::BufferDescription unused;
    unused.name = "unused texels";
    unused.usage = VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT;
    unused.texel_format = VK_FORMAT_R32_SFLOAT;
    SUNFLECK_ASSIGN(technique->unused_texels_, gpu::Buffer::create(device, unused));
    unused.texel_format = VK_FORMAT_R32_UINT;
    SUNFLECK_ASSIGN(technique->unused_words_, gpu::Buffer::create(device, unused));
    return technique;
}

ManyLight::~ManyLight() {
    device_.vk.vkDestroySampler(device_.handle(), sampler_, nullptr);
}

void ManyLight::restart() {
    light_maps_->restart();
    baked_light_->forget();
    refined_light_->restart();
    tables_.restart();
}

Status ManyLight::update(const ManyLightScene& scene, const RefinedLightScene& refined, const ManyLightOptions& options,
                         gpu::FrameResources& resources) {
    VisibilityDatabase& database = scene.database;
    gpu_scene_ = &scene.gpu_scene;
    if (options.light_maps && options.visibility)
        SUNFLECK_TRY(light_maps_->update(database, scene.samples, scene.rows, options.bake_in_portions, resources));
    else
        light_maps_->restart(); // they miss what changes meanwhile
    if (std::exchange(baked_with_filter_, options.filter) != options.filter)
        baked_light_->forget(); // it holds what the other look-up said
    if (options.baked_light && options.light_maps && options.visibility && options.shadows)
        SUNFLECK_TRY(baked_light_->update(scene, *light_maps_, options.static_maps_changed, options.bake_in_portions,
                                          resources));
    else
        baked_light_->forget();
    if (options.static_maps_changed)
        refined_light_->forget();
    marked_again_ = baked_light_->marks_again();
    SUNFLECK_TRY(refined_light_->update(refined, *baked_light_, options.refinement_budget, resources));
    baked_light_->judge_by(refined_light_->texels(), refined_light_->share() == 1.0f);
    shared::NodeRow bare{};
    bare.first_texel = shared::no_light_map;
    std::vector<shared::NodeRow> node_rows;
    if (light_maps_->complete())
        node_rows = light_maps_->node_rows();
    node_rows.resize(std::max<std::size_t>(database.node_count(), 1), bare);
    const bool changed =
        node_rows.size() != node_rows_.size() ||
        std::memcmp(node_rows.data(), node_rows_.data(), std::as_bytes(std::span(node_rows)).size()) != 0;
    node_rows_ = std::move(node_rows);
    words_per_row_ = database.words_per_row();
    state_words_ = database.state_words();
    flag_words_ = database.flag_words();
    first_mover_ = std::uint32_t(database.patches().nodes().size());
    std::vector<vec4> spheres;
    for (const scene::DrawItem& item : scene.gpu_scene.draws())
        if (!item.is_static && item.casts_shadow)
            spheres.emplace_back(item.bounds.centre(), 0.5f * glm::length(item.bounds.extent()));
    mover_count_ = std::uint32_t(spheres.size());
    spheres.resize(std::clamp<std::size_t>(spheres.size(), 1, shared::max_culled_movers));
    SUNFLECK_ASSIGN(movers_, resources.upload(std::span<const vec4>(spheres)));
    return tables_.update(device_, scene, node_rows_, changed, resources);
}

Status ManyLight::make_buffer(gpu::Buffer& buffer, const char* name, std::uint64_t bytes, VkBufferUsageFlags usage,
                              gpu::FrameResources& resources) {
    if (buffer && buffer.size() >= bytes)
        return {};
    if (buffer)
        resources.retire(std::move(buffer));
    SUNFLECK_ASSIGN(buffer, gpu::Buffer::create(device_, {name, bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | usage,
                                                          gpu::MemoryUse::device, VK_FORMAT_UNDEFINED}));
    return {};
}

Status ManyLight::make_buffers(const shared::ManyLightConstants& constants, gpu::FrameResources& resources) {
    const std::uint64_t groups = std::max(constants.group_capacity, constants.group_count);
    const std::uint64_t entries = groups * shared::pixel_group_size;
    const std::uint64_t blocks = divide_up(std::uint32_t(groups), shared::pixel_groups_per_block);
    SUNFLECK_TRY(make_buffer(nodes_, "nodes of groups", entries * 4, 0, resources));
    SUNFLECK_TRY(make_buffer(ratios_, "refined light of groups", entries * 8, 0, resources));
    SUNFLECK_TRY(make_buffer(local_nodes_, "local nodes of groups", entries * 4, 0, resources));
    SUNFLECK_TRY(make_buffer(entries_, "lists of groups", groups * constants.list_stride * 4, 0, resources));
    SUNFLECK_TRY(make_buffer(counts_, "list lengths", groups * sizeof(shared::LightListCounts), 0, resources));
    SUNFLECK_TRY(make_buffer(block_groups_, "rough blocks", blocks * 4, 0, resources));
    SUNFLECK_TRY(make_buffer(rough_entries_, "rough entries", entries * 4, 0, resources));
    return make_buffer(rough_commands_, "rough commands", shared::command_words * 4,
                       VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT, resources);
}

shared::ManyLightConstants ManyLight::make_constants(const shared::LowResolutionConstants& low) const {
    shared::ManyLightConstants constants{};
    constants.width = low.width;
    constants.height = low.height;
    constants.low_width = low.low_width;
    constants.low_height = low.low_height;
    constants.scale = low.scale;
    constants.group_columns = low.group_columns;
    constants.group_count = low.group_count;
    constants.group_capacity = low.group_capacity;
    constants.cell_columns = low.cell_columns;
    constants.list_stride = list_stride_;
    constants.words_per_row = words_per_row_;
    constants.state_words = state_words_;
    constants.flag_words = flag_words_;
    constants.mover_count = mover_count_;
    constants.map_resolution = maps_->resolution();
    constants.fixed_point = light_maps_->fixed_point();
    constants.node_count = std::uint32_t(node_rows_.size());
    constants.first_mover = first_mover_;
    return constants;
}

Status ManyLight::add_passes(gpu::FrameGraph& graph, const ManyLightInput& input, const ManyLightOptions& options,
                             gpu::FrameResources& resources) {
    options_ = options;
    maps_ = &input.maps;
    batches_.assign(input.batches.begin(), input.batches.end());
    map_ages_.assign(input.map_ages.begin(), input.map_ages.end());
    list_stride_ = 1;
    for (const LightBatch& batch : batches_)
        list_stride_ = std::max(list_stride_, batch.count);
    tables_.add_passes(graph);
    if (options.light_maps && options.visibility)
        SUNFLECK_TRY(light_maps_->add_passes(graph, resources));
    if (!baked_light_->in_use())
        return {};
    SUNFLECK_TRY(baked_light_->add_passes(graph, input.maps, options.filter, resources));
    return refined_light_->add_passes(graph, *gpu_scene_, *baked_light_, input.maps, options.filter, resources);
}

Status ManyLight::light(const PixelStage& stage, gpu::FrameResources& resources) {
    if (!stage.first)
        return Error{"the many-light system must be the first technique that lights pixels"};
    const bool shows = options_.show != shared::show_nothing;
    // Other false colours are of the work that there is without baked light.
    const bool baked = baked_light_->in_use() && (!shows || options_.show == shared::show_baked);
    Frame frame{stage, options_, *maps_, make_constants(stage.constants), baked, baked && refines()};
    frame.constants.refined_share = frame.refined ? refined_light_->share() : 0.0f;
    SUNFLECK_TRY(make_buffers(frame.constants, resources));
    // False colours show the groups of the low-resolution picture.
    if (!stage.repair || !shows) {
        SUNFLECK_TRY(add_gather(frame));
        if (options_.show != shared::show_light_maps && options_.show != shared::show_baked)
            SUNFLECK_TRY(add_lighting(frame));
    }
    return shows && stage.resolves ? add_show(frame, resources) : Status();
}

std::uint64_t ManyLight::memory_bytes() const {
    std::uint64_t bytes = tables_.memory_bytes() + light_maps_->texels().size() + baked_light_->memory_bytes() +
                          refined_light_->memory_bytes();
    for (const gpu::Buffer* buffer :
         {&nodes_, &ratios_, &local_nodes_, &entries_, &counts_, &block_groups_, &rough_entries_, &rough_commands_})
        bytes += buffer->size();
    return bytes;
}

} // namespace sunfleck::gi

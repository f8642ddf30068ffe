#include "gi_module/many_light/many_light_frame.h"

#include <algorithm>
#include <cstring>

namespace sunfleck::gi {
namespace {

constexpr std::uint64_t repair_list_bytes = std::uint64_t(24) << 20; // bound of the lists of samples
constexpr std::uint32_t least_repair_share = 4;                      // a quarter of the picture, where that fits
constexpr std::uint64_t small_picture_groups = 512;                  // all of a picture of 32,768 pixels

} // namespace

Result<std::unique_ptr<ManyLight>> ManyLight::create(gpu::Device& device, gpu::PipelineStore& pipelines) {
    std::unique_ptr<ManyLight> technique(new ManyLight(device, pipelines));
    SUNFLECK_ASSIGN(technique->light_maps_, LightMaps::create(device, pipelines));
    SUNFLECK_ASSIGN(technique->baked_light_, BakedLight::create(device, pipelines));
    VkSamplerCreateInfo sampler{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
    SUNFLECK_VK(device.vk.vkCreateSampler(device.handle(), &sampler, nullptr, &technique->sampler_),
                "creating a sampler");
    gpu::BufferDescription unused;
    unused.name = "unused texels";
    unused.usage = VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT;
    unused.texel_format = VK_FORMAT_R32_SFLOAT;
    SUNFLECK_ASSIGN(technique->unused_texels_, gpu::Buffer::create(device, unused));
    return technique;
}

ManyLight::~ManyLight() {
    device_.vk.vkDestroySampler(device_.handle(), sampler_, nullptr);
}

Status ManyLight::update(VisibilityDatabase& database, const CurvedCharts& curved, const scene::GpuScene& scene,
                         std::span<const LightSample> samples, std::span<const shared::LightRow> rows,
                         const ManyLightOptions& options, std::uint64_t serial, std::uint64_t completed_serial,
                         gpu::FrameResources& resources) {
    serial_ = serial;
    completed_serial_ = completed_serial;
    collect(completed_serial);
    if (options.light_maps && options.visibility)
        SUNFLECK_TRY(light_maps_->update(database, samples, rows, resources));
    if (options.baked_light && options.light_maps && options.visibility && options.shadows)
        SUNFLECK_TRY(baked_light_->update(database, *light_maps_, curved, samples, rows, options.static_maps_changed,
                                          resources));
    else
        baked_light_->forget();
    shared::NodeRow bare{};
    bare.first_texel = shared::no_light_map;
    std::vector<shared::NodeRow> node_rows = light_maps_->node_rows();
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
    for (const scene::DrawItem& item : scene.draws())
        if (!item.is_static && item.casts_shadow)
            spheres.emplace_back(item.bounds.centre(), 0.5f * glm::length(item.bounds.extent()));
    mover_count_ = std::uint32_t(spheres.size());
    spheres.resize(std::clamp<std::size_t>(spheres.size(), 1, shared::most_movers));
    SUNFLECK_ASSIGN(movers_, resources.upload(std::span<const vec4>(spheres)));
    return tables_.update(device_, database, curved, scene, node_rows_, changed, resources);
}

Status ManyLight::make_buffer(gpu::Buffer& buffer, const char* name, std::uint64_t bytes, VkBufferUsageFlags usage,
                              gpu::FrameResources& resources, VkFormat texel_format) {
    if (buffer && buffer.size() >= bytes)
        return {};
    if (buffer)
        resources.retire(std::move(buffer));
    SUNFLECK_ASSIGN(buffer, gpu::Buffer::create(device_, {name, bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | usage,
                                                          gpu::MemoryUse::device, texel_format}));
    return {};
}

Status ManyLight::make_buffers(const shared::ManyLightConstants& constants, gpu::FrameResources& resources) {
    const std::uint64_t groups = std::max(constants.group_capacity, constants.group_count);
    const std::uint64_t pixels = groups * shared::group_pixels;
    SUNFLECK_TRY(make_buffer(pixels_, "pixels of groups", pixels * 4, 0, resources));
    SUNFLECK_TRY(make_buffer(nodes_, "nodes of groups", pixels * 4, 0, resources));
    SUNFLECK_TRY(make_buffer(slots_, "slots of groups", pixels * 4, 0, resources));
    SUNFLECK_TRY(make_buffer(sums_, "sums of groups", pixels * 16, VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT, resources,
                             VK_FORMAT_R32G32B32A32_SFLOAT));
    SUNFLECK_TRY(make_buffer(entries_, "lists of groups", groups * constants.list_stride * 4, 0, resources));
    SUNFLECK_TRY(make_buffer(counts_, "list lengths", groups * sizeof(shared::GroupCounts), 0, resources));
    SUNFLECK_TRY(make_buffer(cell_masks_, "repair masks",
                             std::uint64_t(constants.cell_columns) * constants.cell_rows * 8, 0, resources));
    const std::uint64_t blocks =
        std::max<std::uint64_t>(constants.block_count, divide_up(std::uint32_t(groups), shared::groups_per_block));
    SUNFLECK_TRY(make_buffer(block_groups_, "repair blocks", blocks * 4, 0, resources));
    SUNFLECK_TRY(make_buffer(rough_entries_, "rough entries", pixels * 4, 0, resources));
    for (gpu::Buffer* commands : {&commands_, &rough_commands_})
        SUNFLECK_TRY(make_buffer(*commands, "repair commands", shared::command_words * 4,
                                 VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT, resources));
    return {};
}

shared::ManyLightConstants ManyLight::make_constants(const GBufferInput& g_buffer, const ShadowMaps& maps,
                                                     std::span<const LightBatch> batches,
                                                     const ManyLightOptions& options) const {
    shared::ManyLightConstants constants{};
    constants.width = g_buffer.width;
    constants.height = g_buffer.height;
    constants.scale = options.scale;
    constants.low_width = divide_up(g_buffer.width, options.scale);
    constants.low_height = divide_up(g_buffer.height, options.scale);
    constants.group_columns = divide_up(constants.low_width, shared::group_side);
    constants.group_count = constants.group_columns * divide_up(constants.low_height, shared::group_side);
    constants.words_per_row = words_per_row_;
    constants.state_words = state_words_;
    constants.flag_words = flag_words_;
    constants.mover_count = mover_count_;
    constants.map_resolution = maps.resolution();
    constants.cell_columns = constants.low_width + 1;
    constants.cell_rows = constants.low_height + 1;
    constants.block_columns = divide_up(constants.cell_columns, 8);
    constants.block_count = constants.block_columns * divide_up(constants.cell_rows, 8);
    constants.contrast = options.contrast;
    // A radian is 0.64 (about an axis) to 1.04 (between axes) octahedral units; the smaller, so that none is missed.
    const float limit = 0.64f * glm::radians(options.normal_degrees);
    constants.normal_limit = limit * limit;
    constants.fixed_point = light_maps_->fixed_point();
    constants.node_count = std::uint32_t(node_rows_.size());
    constants.first_mover = first_mover_;
    for (const LightBatch& batch : batches)
        constants.list_stride = std::max(constants.list_stride, std::max(batch.count, 1u));
    const std::uint64_t whole = std::uint64_t(divide_up(g_buffer.width * g_buffer.height, shared::group_pixels));
    constants.group_capacity = std::uint32_t(
        std::clamp<std::uint64_t>(std::max(whole / least_repair_share, std::min(whole, small_picture_groups)), 64,
                                  repair_list_bytes / (std::uint64_t(constants.list_stride) * 4)));
    return constants;
}

Status ManyLight::add_passes(gpu::FrameGraph& graph, const GBufferInput& g_buffer, const gpu::UploadSlice& camera,
                             const ShadowMaps& maps, std::span<const LightBatch> batches,
                             std::span<const std::uint32_t> map_ages, const ManyLightOptions& wanted,
                             gpu::FrameResources& resources, gpu::ResourceId output) {
    ManyLightOptions options = wanted;
    if (options.show >= shared::show_visibility)
        options.scale = 1; // these are shown for every pixel
    const shared::ManyLightConstants constants = make_constants(g_buffer, maps, batches, options);
    SUNFLECK_TRY(make_buffers(constants, resources));
    tables_.add_passes(graph);
    if (options.light_maps && options.visibility)
        SUNFLECK_TRY(light_maps_->add_passes(graph, resources));
    // Other false colours are of the work that there is without it.
    const bool baked =
        baked_light_->in_use() && (options.show == shared::show_nothing || options.show == shared::show_baked);
    if (baked_light_->in_use())
        SUNFLECK_TRY(baked_light_->add_passes(graph, maps, options.filter, resources));

    Frame frame{graph, g_buffer, camera, maps, options, output, constants, baked};
    const bool reconstructs = options.scale > 1;
    // A CPU device stores to buffers much faster than to images.
    frame.through_buffer = reconstructs && device_.traits().software && !graph.owned_by_host(output) &&
                           graph.description(output).format == VK_FORMAT_R16G16B16A16_SFLOAT;
    SUNFLECK_TRY(make_buffer(picture_, "reconstructed picture",
                             frame.through_buffer ? std::uint64_t(constants.width) * constants.height * 8 : 8,
                             VK_BUFFER_USAGE_TRANSFER_SRC_BIT, resources));
    for (const Stage stage : {Stage::low_resolution, Stage::repair}) {
        if (stage == Stage::repair && !reconstructs)
            break;
        if (stage == Stage::repair) {
            SUNFLECK_TRY(add_reconstruction(frame));
            SUNFLECK_TRY(add_compaction(frame));
        }
        if (stage == Stage::repair && options.show != shared::show_nothing)
            break; // the groups of the low-resolution picture are what is shown
        SUNFLECK_TRY(add_gather(frame, stage));
        if (options.show == shared::show_light_maps || options.show == shared::show_baked)
            break;
        SUNFLECK_TRY(add_lighting(frame, stage, batches));
    }
    if (options.show != shared::show_nothing)
        SUNFLECK_TRY(add_show(frame, map_ages, resources));
    if (reconstructs)
        SUNFLECK_TRY(add_counters(frame));
    else
        counters_ = {};
    return {};
}

void ManyLight::collect(std::uint64_t completed_serial) {
    const gpu::ReadbackRing::Slot* const slot = readback_.collect(completed_serial);
    if (slot == nullptr)
        return;
    const auto words = gpu::ReadbackRing::content<std::uint32_t>(*slot);
    const std::uint64_t wanted = words[shared::command_totals], lit = words[shared::command_totals + 1];
    counters_ = {slot->tag, lit, wanted - lit, slot->serial};
}

std::uint64_t ManyLight::memory_bytes() const {
    std::uint64_t bytes = tables_.memory_bytes() + light_maps_->texels().size() + baked_light_->memory_bytes();
    for (const gpu::Buffer* buffer : {&pixels_, &nodes_, &slots_, &sums_, &entries_, &counts_, &cell_masks_,
                                      &block_groups_, &commands_, &rough_entries_, &rough_commands_, &picture_})
        bytes += buffer->size();
    return bytes;
}

} // namespace sunfleck::gi

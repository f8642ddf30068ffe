#include "gi_module/many_light/many_light.h"

#include "gi_module/shadows/octahedral_map.h"

#include <algorithm>
#include <cstring>

namespace sunfleck::gi {
namespace {

using enum gpu::BindingKind;

constexpr std::uint64_t repair_list_bytes = std::uint64_t(24) << 20; // bound of the lists of samples
constexpr std::uint32_t least_repair_share = 4;                      // a quarter of the picture, where that fits

std::uint32_t divide_up(std::uint32_t value, std::uint32_t by) {
    return (value + by - 1) / by;
}

} // namespace

// What the passes of one frame share.
struct ManyLight::Frame {
    gpu::FrameGraph& graph;
    const GBufferInput& g_buffer;
    const gpu::UploadSlice& camera;
    const ShadowMaps& maps;
    const ManyLightOptions& options;
    gpu::ResourceId output;
    shared::ManyLightConstants constants;
    gpu::ResourceId pixels, nodes, slots, sums, entries, counts, cell_masks, block_groups, commands;
    bool first_batch = true;
};

Result<std::unique_ptr<ManyLight>> ManyLight::create(gpu::Device& device, gpu::PipelineStore& pipelines) {
    std::unique_ptr<ManyLight> technique(new ManyLight(device, pipelines));
    SUNFLECK_ASSIGN(technique->light_maps_, LightMaps::create(device, pipelines));
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

Status ManyLight::update(VisibilityDatabase& database, const scene::GpuScene& scene,
                         std::span<const LightSample> samples, std::span<const shared::LightRow> rows,
                         const ManyLightOptions& options, std::uint64_t serial, std::uint64_t completed_serial,
                         gpu::FrameResources& resources) {
    serial_ = serial;
    completed_serial_ = completed_serial;
    collect(completed_serial);
    if (options.light_maps && options.visibility)
        SUNFLECK_TRY(light_maps_->update(database, samples, rows, resources));
    shared::NodeRow bare{};
    bare.first_texel = shared::no_light_map;
    std::vector<shared::NodeRow> node_rows = light_maps_->node_rows();
    node_rows.resize(std::max<std::size_t>(database.node_count(), 1), bare);
    const bool changed =
        node_rows.size() != node_rows_.size() ||
        std::memcmp(node_rows.data(), node_rows_.data(), std::as_bytes(std::span(node_rows)).size()) != 0;
    node_rows_ = std::move(node_rows);
    words_per_row_ = database.words_per_row();
    first_mover_ = std::uint32_t(database.patches().nodes().size());
    return tables_.update(device_, database, scene, node_rows_, changed, resources);
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

Status ManyLight::make_buffers(const shared::ManyLightConstants& constants, std::uint32_t blocks,
                               gpu::FrameResources& resources) {
    const std::uint64_t groups = std::max(constants.group_capacity, constants.group_count);
    const std::uint64_t pixels = groups * shared::group_pixels;
    SUNFLECK_TRY(make_buffer(pixels_, "pixels of groups", pixels * 4, 0, resources));
    SUNFLECK_TRY(make_buffer(nodes_, "nodes of groups", pixels * 4, 0, resources));
    SUNFLECK_TRY(make_buffer(slots_, "slots of groups", pixels * 4, 0, resources));
    SUNFLECK_TRY(make_buffer(sums_, "sums of groups", pixels * 16, 0, resources));
    SUNFLECK_TRY(make_buffer(entries_, "lists of groups", groups * constants.list_stride * 4, 0, resources));
    SUNFLECK_TRY(make_buffer(counts_, "list lengths", groups * sizeof(shared::GroupCounts), 0, resources));
    SUNFLECK_TRY(make_buffer(cell_masks_, "repair masks",
                             std::uint64_t(constants.cell_columns) * constants.cell_rows * 8, 0, resources));
    SUNFLECK_TRY(make_buffer(block_groups_, "repair blocks", blocks * 4, 0, resources));
    return make_buffer(commands_, "repair commands", shared::command_words * 4,
                       VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT, resources);
}

Result<const gpu::Pipeline*> ManyLight::pipeline(const char* shader, std::vector<gpu::BindingKind> bindings,
                                                 std::vector<std::uint32_t> specialization) {
    const auto key = std::pair(std::string(shader), specialization);
    if (const auto found = kernels_.find(key); found != kernels_.end())
        return found->second;
    gpu::ComputeDescription description;
    description.shader = std::string("gi_module/many_light/") + shader;
    description.bindings = std::move(bindings);
    description.push_constant_bytes = sizeof(shared::ManyLightConstants);
    description.specialization = std::move(specialization);
    SUNFLECK_ASSIGN(const gpu::Pipeline* made, pipelines_.compute(description));
    kernels_[key] = made;
    return made;
}

Status ManyLight::add_passes(gpu::FrameGraph& graph, const GBufferInput& g_buffer, const gpu::UploadSlice& camera,
                             const ShadowMaps& maps, std::span<const LightBatch> batches,
                             std::span<const std::uint32_t> map_ages, const ManyLightOptions& wanted,
                             gpu::FrameResources& resources, gpu::ResourceId output) {
    ManyLightOptions options = wanted;
    if (options.show >= shared::show_visibility)
        options.scale = 1; // these are shown for every pixel
    shared::ManyLightConstants constants{};
    constants.width = g_buffer.width;
    constants.height = g_buffer.height;
    constants.scale = options.scale;
    constants.low_width = divide_up(g_buffer.width, options.scale);
    constants.low_height = divide_up(g_buffer.height, options.scale);
    constants.group_columns = divide_up(constants.low_width, shared::group_side);
    constants.group_count = constants.group_columns * divide_up(constants.low_height, shared::group_side);
    constants.words_per_row = words_per_row_;
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
    constants.group_capacity = std::uint32_t(std::clamp<std::uint64_t>(
        whole / least_repair_share, 64, repair_list_bytes / (std::uint64_t(constants.list_stride) * 4)));
    SUNFLECK_TRY(make_buffers(constants, constants.block_count, resources));
    tables_.add_passes(graph);
    if (options.light_maps && options.visibility)
        SUNFLECK_TRY(light_maps_->add_passes(graph, resources));

    Frame frame{graph,
                g_buffer,
                camera,
                maps,
                options,
                output,
                constants,
                graph.import_buffer(pixels_),
                graph.import_buffer(nodes_),
                graph.import_buffer(slots_),
                graph.import_buffer(sums_),
                graph.import_buffer(entries_),
                graph.import_buffer(counts_),
                graph.import_buffer(cell_masks_),
                graph.import_buffer(block_groups_),
                graph.import_buffer(commands_)};
    const bool reconstructs = options.scale > 1;
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
        if (options.show == shared::show_light_maps)
            break;
        for (std::size_t i = 0; i < batches.size(); ++i) {
            frame.constants.batch_first = batches[i].first;
            frame.constants.batch_count = batches[i].count;
            SUNFLECK_TRY(add_classify(frame, stage, batches[i]));
            SUNFLECK_TRY(add_light(frame, stage, batches[i], i + 1 == batches.size()));
        }
    }
    if (options.show != shared::show_nothing)
        SUNFLECK_TRY(add_show(frame, map_ages, resources));
    if (reconstructs)
        SUNFLECK_TRY(add_counters(frame));
    else
        counters_ = {};
    return {};
}

void ManyLight::dispatch(gpu::PassContext& context, Stage stage, std::uint32_t command, std::uint32_t groups) const {
    if (stage == Stage::repair)
        context.device.vk.vkCmdDispatchIndirect(context.commands, commands_.handle(), VkDeviceSize(command) * 4);
    else
        context.device.vk.vkCmdDispatch(context.commands, groups, 1, 1);
}

Status ManyLight::add_gather(const Frame& frame, Stage stage) {
    const bool maps = frame.options.light_maps && frame.options.visibility;
    SUNFLECK_ASSIGN(
        const gpu::Pipeline* kernel,
        pipeline("gather.comp",
                 {uniform_buffer, sampled_image, sampled_image, sampled_image, storage_buffer, storage_buffer,
                  storage_buffer, storage_buffer, storage_buffer, storage_buffer, storage_buffer, storage_buffer},
                 {stage == Stage::repair, maps}));
    auto pass = frame.graph.add_pass(stage == Stage::repair ? "repair" : "low-resolution pixels");
    if (stage == Stage::repair)
        pass.read(frame.commands, gpu::Usage::indirect_read);
    pass.read(frame.g_buffer.depth, gpu::Usage::sampled)
        .read(frame.g_buffer.normals, gpu::Usage::sampled)
        .read(frame.g_buffer.surface, gpu::Usage::sampled);
    for (const gpu::Buffer* table : {&tables_.charts(), &tables_.cells(), &tables_.nodes(), &light_maps_->texels()})
        pass.read(frame.graph.import_buffer(*table), gpu::Usage::storage_read);
    pass.write(frame.pixels, gpu::Usage::storage_read_write)
        .write(frame.nodes, gpu::Usage::storage_write)
        .write(frame.sums, gpu::Usage::storage_write)
        .execute([this, kernel, stage, camera = frame.camera, g_buffer = frame.g_buffer,
                  constants = frame.constants](gpu::PassContext& context) -> Status {
            const gpu::Binding bindings[] = {
                gpu::Binding::slice(camera),
                gpu::Binding::sampled_image(context.graph.view(g_buffer.depth), sampler_),
                gpu::Binding::sampled_image(context.graph.view(g_buffer.normals), sampler_),
                gpu::Binding::sampled_image(context.graph.view(g_buffer.surface), sampler_),
                gpu::Binding::slice(tables_.instances()),
                gpu::Binding::buffer(tables_.charts()),
                gpu::Binding::buffer(tables_.cells()),
                gpu::Binding::buffer(tables_.nodes()),
                gpu::Binding::buffer(pixels_),
                gpu::Binding::buffer(nodes_),
                gpu::Binding::buffer(sums_),
                gpu::Binding::buffer(light_maps_->texels())};
            SUNFLECK_TRY(context.resources.bind(context.commands, *kernel, bindings));
            context.resources.push(context.commands, *kernel, constants);
            dispatch(context, stage, shared::command_groups, constants.group_count);
            return {};
        });
    return {};
}

Status ManyLight::add_classify(const Frame& frame, Stage stage, const LightBatch& batch) {
    const bool maps = frame.options.light_maps && frame.options.visibility &&
                      batch.light_class == shared::light_class_surface && !batch.dynamic;
    SUNFLECK_ASSIGN(const gpu::Pipeline* kernel, pipeline("classify.comp", std::vector(9, storage_buffer),
                                                          {stage == Stage::repair, maps, frame.options.visibility}));
    auto pass = frame.graph.add_pass(stage == Stage::repair ? "repair" : "tiles");
    if (stage == Stage::repair)
        pass.read(frame.commands, gpu::Usage::indirect_read);
    pass.read(frame.commands, gpu::Usage::storage_read)
        .read(frame.pixels, gpu::Usage::storage_read)
        .read(frame.nodes, gpu::Usage::storage_read)
        .read(frame.graph.import_buffer(tables_.nodes()), gpu::Usage::storage_read)
        .read(frame.graph.import_buffer(tables_.rows()), gpu::Usage::storage_read)
        .write(frame.slots, gpu::Usage::storage_write)
        .write(frame.entries, gpu::Usage::storage_write)
        .write(frame.counts, gpu::Usage::storage_write)
        .write(frame.sums, gpu::Usage::storage_write)
        .execute([this, kernel, stage, constants = frame.constants](gpu::PassContext& context) -> Status {
            const gpu::Binding bindings[] = {gpu::Binding::buffer(pixels_),
                                             gpu::Binding::buffer(nodes_),
                                             gpu::Binding::buffer(tables_.nodes()),
                                             gpu::Binding::buffer(tables_.rows()),
                                             gpu::Binding::buffer(slots_),
                                             gpu::Binding::buffer(entries_),
                                             gpu::Binding::buffer(counts_),
                                             gpu::Binding::buffer(commands_),
                                             gpu::Binding::buffer(sums_)};
            SUNFLECK_TRY(context.resources.bind(context.commands, *kernel, bindings));
            context.resources.push(context.commands, *kernel, constants);
            dispatch(context, stage, shared::command_packed, divide_up(constants.group_count, 8));
            return {};
        });
    return {};
}

Status ManyLight::add_light(const Frame& frame, Stage stage, const LightBatch& batch, bool last) {
    const bool to_image = last && (stage == Stage::repair || frame.options.scale == 1);
    const std::uint32_t lanes = device_.traits().software ? 8 : 64;
    SUNFLECK_ASSIGN(
        const gpu::Pipeline* kernel,
        pipeline("light.comp",
                 {uniform_buffer, sampled_image, sampled_image, uniform_buffer, texel_buffer, storage_buffer,
                  storage_buffer, storage_buffer, storage_buffer, storage_buffer, storage_image},
                 {shared::group_pixels / lanes, batch.light_class,
                  frame.options.shadows ? shared::maps_texel_buffer : shared::maps_none,
                  filters_maps(frame.options.filter, batch.light_class), frame.maps.bits(), to_image, lanes,
                  frame.options.stale_maps}));
    auto pass = frame.graph.add_pass(stage == Stage::repair ? "repair" : "low-resolution light");
    if (stage == Stage::repair)
        pass.read(frame.commands, gpu::Usage::indirect_read);
    if (frame.maps.texels())
        pass.read(frame.graph.import_buffer(frame.maps.texels()), gpu::Usage::texel_read);
    pass.read(frame.g_buffer.depth, gpu::Usage::sampled).read(frame.g_buffer.normals, gpu::Usage::sampled);
    for (const gpu::ResourceId list : {frame.pixels, frame.slots, frame.entries, frame.counts})
        pass.read(list, gpu::Usage::storage_read);
    pass.write(frame.sums, gpu::Usage::storage_read_write)
        .write(frame.output, gpu::Usage::storage_write)
        .execute([this, kernel, stage, batch, camera = frame.camera, g_buffer = frame.g_buffer, output = frame.output,
                  &maps = frame.maps, constants = frame.constants](gpu::PassContext& context) -> Status {
            const gpu::Binding bindings[] = {
                gpu::Binding::slice(camera),
                gpu::Binding::sampled_image(context.graph.view(g_buffer.depth), sampler_),
                gpu::Binding::sampled_image(context.graph.view(g_buffer.normals), sampler_),
                gpu::Binding::slice(batch.rows),
                gpu::Binding::texels(maps.texels() ? maps.texels() : unused_texels_),
                gpu::Binding::buffer(pixels_),
                gpu::Binding::buffer(slots_),
                gpu::Binding::buffer(entries_),
                gpu::Binding::buffer(counts_),
                gpu::Binding::buffer(sums_),
                gpu::Binding::storage_image(context.graph.view(output))};
            SUNFLECK_TRY(context.resources.bind(context.commands, *kernel, bindings));
            context.resources.push(context.commands, *kernel, constants);
            dispatch(context, stage, shared::command_groups, constants.group_count);
            return {};
        });
    return {};
}

Status ManyLight::add_reconstruction(const Frame& frame) {
    SUNFLECK_ASSIGN(const gpu::Pipeline* kernel, pipeline("reconstruct.comp",
                                                          {uniform_buffer, sampled_image, sampled_image, storage_buffer,
                                                           storage_image, storage_buffer},
                                                          {frame.options.scale}));
    frame.graph.add_pass("reconstruction")
        .read(frame.g_buffer.depth, gpu::Usage::sampled)
        .read(frame.g_buffer.normals, gpu::Usage::sampled)
        .read(frame.sums, gpu::Usage::storage_read)
        .write(frame.output, gpu::Usage::storage_write)
        .write(frame.cell_masks, gpu::Usage::storage_write)
        .execute([this, kernel, camera = frame.camera, g_buffer = frame.g_buffer, output = frame.output,
                  constants = frame.constants](gpu::PassContext& context) -> Status {
            const gpu::Binding bindings[] = {
                gpu::Binding::slice(camera),
                gpu::Binding::sampled_image(context.graph.view(g_buffer.depth), sampler_),
                gpu::Binding::sampled_image(context.graph.view(g_buffer.normals), sampler_),
                gpu::Binding::buffer(sums_),
                gpu::Binding::storage_image(context.graph.view(output)),
                gpu::Binding::buffer(cell_masks_)};
            SUNFLECK_TRY(context.resources.bind(context.commands, *kernel, bindings));
            context.resources.push(context.commands, *kernel, constants);
            context.device.vk.vkCmdDispatch(context.commands, divide_up(constants.cell_columns, 8),
                                            divide_up(constants.cell_rows, 8), 1);
            return {};
        });
    return {};
}

Status ManyLight::add_compaction(const Frame& frame) {
    for (std::uint32_t action = 0; action < 3; ++action) {
        SUNFLECK_ASSIGN(const gpu::Pipeline* kernel,
                        pipeline("compact.comp", {storage_buffer, storage_buffer, storage_buffer, storage_buffer},
                                 {action, frame.options.scale}));
        frame.graph.add_pass("compaction")
            .read(frame.cell_masks, gpu::Usage::storage_read)
            .write(frame.block_groups, gpu::Usage::storage_read_write)
            .write(frame.commands, gpu::Usage::storage_read_write)
            .write(frame.pixels, gpu::Usage::storage_read_write)
            .execute([this, kernel, action, constants = frame.constants](gpu::PassContext& context) -> Status {
                const gpu::Binding bindings[] = {gpu::Binding::buffer(cell_masks_), gpu::Binding::buffer(block_groups_),
                                                 gpu::Binding::buffer(commands_), gpu::Binding::buffer(pixels_)};
                SUNFLECK_TRY(context.resources.bind(context.commands, *kernel, bindings));
                context.resources.push(context.commands, *kernel, constants);
                context.device.vk.vkCmdDispatch(context.commands, action == 1 ? 1 : divide_up(constants.block_count, 8),
                                                1, 1);
                return {};
            });
    }
    return {};
}

Status ManyLight::add_show(const Frame& frame, std::span<const std::uint32_t> map_ages,
                           gpu::FrameResources& resources) {
    SUNFLECK_ASSIGN(const gpu::Pipeline* kernel,
                    pipeline("show.comp",
                             {storage_buffer, storage_buffer, storage_buffer, storage_buffer, storage_buffer,
                              storage_buffer, storage_image},
                             {frame.options.show}));
    SUNFLECK_ASSIGN(const gpu::UploadSlice ages, resources.upload(map_ages));
    auto pass = frame.graph.add_pass("false colours");
    for (const gpu::ResourceId id : {frame.nodes, frame.counts, frame.sums, frame.cell_masks})
        pass.read(id, gpu::Usage::storage_read);
    pass.read(frame.graph.import_buffer(tables_.rows()), gpu::Usage::storage_read)
        .write(frame.output, gpu::Usage::storage_write)
        .execute([this, kernel, ages, output = frame.output,
                  constants = frame.constants](gpu::PassContext& context) -> Status {
            const gpu::Binding bindings[] = {gpu::Binding::buffer(nodes_),
                                             gpu::Binding::buffer(tables_.rows()),
                                             gpu::Binding::buffer(counts_),
                                             gpu::Binding::buffer(sums_),
                                             gpu::Binding::buffer(cell_masks_),
                                             gpu::Binding::slice(ages),
                                             gpu::Binding::storage_image(context.graph.view(output))};
            SUNFLECK_TRY(context.resources.bind(context.commands, *kernel, bindings));
            context.resources.push(context.commands, *kernel, constants);
            context.device.vk.vkCmdDispatch(context.commands, divide_up(constants.width, 8),
                                            divide_up(constants.height, 8), 1);
            return {};
        });
    return {};
}

// Copies what the compaction counted to where the CPU can read it, frames later.
Status ManyLight::add_counters(const Frame& frame) {
    auto free = std::find_if(readbacks_.begin(), readbacks_.end(),
                             [&](const Readback& readback) { return readback.serial <= completed_serial_; });
    if (free == readbacks_.end()) {
        Readback fresh;
        SUNFLECK_ASSIGN(fresh.words, gpu::Buffer::create(device_, {"repair counters", shared::command_words * 4,
                                                                   VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                                                                   gpu::MemoryUse::readback, VK_FORMAT_UNDEFINED}));
        readbacks_.push_back(std::move(fresh));
        free = readbacks_.end() - 1;
    }
    free->serial = serial_;
    free->low_resolution = std::uint64_t(frame.constants.low_width) * frame.constants.low_height;
    const gpu::ResourceId target = frame.graph.import_buffer(free->words);
    frame.graph.add_pass("repair counters")
        .read(frame.commands, gpu::Usage::transfer_source)
        .write(target, gpu::Usage::transfer_destination)
        .execute([this, &words = free->words](gpu::PassContext& context) -> Status {
            const VkBufferCopy region{0, 0, shared::command_words * 4};
            context.device.vk.vkCmdCopyBuffer(context.commands, commands_.handle(), words.handle(), 1, &region);
            return {};
        });
    frame.graph.add_pass("repair counters").read(target, gpu::Usage::host_read).keep();
    return {};
}

void ManyLight::collect(std::uint64_t completed_serial) {
    for (const Readback& readback : readbacks_) {
        if (readback.serial == 0 || readback.serial > completed_serial || readback.serial <= counters_.serial)
            continue;
        const auto* words = reinterpret_cast<const std::uint32_t*>(readback.words.mapped());
        const std::uint64_t wanted = words[shared::command_totals], lit = words[shared::command_totals + 1];
        counters_ = {readback.low_resolution, lit, wanted - lit, readback.serial};
    }
}

std::uint64_t ManyLight::memory_bytes() const {
    std::uint64_t bytes = tables_.memory_bytes() + light_maps_->texels().size();
    for (const gpu::Buffer* buffer :
         {&pixels_, &nodes_, &slots_, &sums_, &entries_, &counts_, &cell_masks_, &block_groups_, &commands_})
        bytes += buffer->size();
    return bytes;
}

} // namespace sunfleck::gi

// The passes of the many-light system, in the order of the frame.
#include "gi_module/many_light/many_light_frame.h"

#include "engine/gpu/compute_pass.h"
#include "gi_module/shadows/octahedral_map.h"

namespace sunfleck::gi {

Result<const gpu::Pipeline*> ManyLight::pipeline(const char* shader, std::vector<std::uint32_t> specialization) {
    gpu::ComputeDescription description;
    description.shader = std::string("gi_module/many_light/") + shader;
    description.specialization = std::move(specialization);
    return pipelines_.compute(description);
}

namespace {

// What compact.comp does, by its first specialisation constant.
constexpr const char* compaction_steps[] = {"count", "offsets", "list"};

} // namespace

std::string ManyLight::pass_name(const char* low_resolution, const char* repair, Stage stage, Phase phase) {
    const char* const suffix = phase == Phase::rough ? " (rough)" : phase == Phase::baked ? " (baked)" : "";
    return std::string(stage == Stage::repair ? repair : low_resolution) + suffix;
}

// How many groups there are is counted on the GPU for all but the low-resolution picture as a whole.
void ManyLight::dispatch(gpu::ComputePass& pass, Stage stage, Phase phase, std::uint32_t command,
                         std::uint32_t groups) const {
    if (stage == Stage::repair || phase == Phase::rough)
        pass.dispatch_indirect(phase == Phase::rough ? rough_commands_ : commands_, VkDeviceSize(command) * 4);
    else
        pass.dispatch(groups);
}

// What the pixels of a stage's groups get from all samples.
Status ManyLight::add_lighting(Frame& frame, Stage stage, std::span<const LightBatch> batches) {
    const auto add = [&](Phase phase, const LightBatch& batch, bool first, bool last) -> Status {
        frame.constants.batch_first = batch.first;
        frame.constants.batch_count = batch.count;
        if (phase == Phase::baked)
            SUNFLECK_TRY(add_classify_baked(frame, stage, batch));
        else
            SUNFLECK_TRY(add_classify(frame, stage, phase, batch, first));
        return add_light(frame, stage, phase, batch, last);
    };
    if (frame.baked) {
        SUNFLECK_TRY(add_rough_list(frame, stage));
        bool first = true;
        for (const LightBatch& batch : batches)
            if (frame.is_held(batch)) {
                SUNFLECK_TRY(add(Phase::rough, batch, first, false));
                first = false;
            }
    }
    for (std::size_t i = 0; i < batches.size(); ++i) {
        const Phase phase = frame.baked && frame.is_held(batches[i]) ? Phase::baked : Phase::plain;
        SUNFLECK_TRY(add(phase, batches[i], i == 0 && !frame.baked, i + 1 == batches.size()));
    }
    return {};
}

Status ManyLight::add_gather(const Frame& frame, Stage stage) {
    const bool maps = frame.options.light_maps && frame.options.visibility;
    SUNFLECK_ASSIGN(const gpu::Pipeline* kernel, pipeline("gather.comp", {stage == Stage::repair, maps, frame.baked}));
    gpu::ComputePass pass(frame.graph, pass_name("low-resolution pixels", "repair pixels", stage, Phase::plain),
                          *kernel);
    pass.uniform(frame.camera)
        .sampled(frame.g_buffer.depth, sampler_)
        .sampled(frame.g_buffer.normals, sampler_)
        .sampled(frame.g_buffer.surface, sampler_)
        .texels(tables_.instances())
        .texels(tables_.charts())
        .texels(tables_.cells())
        .texels(tables_.nodes())
        .storage_read_write(pixels_)
        .storage_write(nodes_)
        .storage_write(sums_)
        .storage_read(light_maps_->texels())
        .texels(baked_light_->texels())
        .texels(frame.baked ? baked_light_->curved_rows() : unused_texels_)
        .push(frame.constants);
    dispatch(pass, stage, Phase::plain, shared::command_groups, frame.constants.group_count);
    return {};
}

// The entries of a stage's groups that did not take baked light, as groups of their own.
Status ManyLight::add_rough_list(Frame& frame, Stage stage) {
    const bool repair = stage == Stage::repair;
    frame.constants.entry_blocks =
        divide_up(repair ? frame.constants.group_capacity : frame.constants.group_count, shared::groups_per_block);
    for (std::uint32_t action = 0; action < 3; ++action) {
        SUNFLECK_ASSIGN(const gpu::Pipeline* kernel,
                        pipeline("compact.comp", {action, frame.options.scale, 1u, repair}));
        const std::string name = repair ? "repair rough pixels " : "rough pixels ";
        gpu::ComputePass(frame.graph, name + compaction_steps[action], *kernel)
            .unused(cell_masks_)
            .storage_read_write(block_groups_)
            .storage_read_write(rough_commands_)
            .storage_read_write(rough_entries_)
            .storage_read(pixels_)
            .storage_read(nodes_)
            .storage_read(commands_)
            .push(frame.constants)
            .dispatch(action == 1 ? 1 : divide_up(frame.constants.entry_blocks, 8));
    }
    return {};
}

Status ManyLight::add_classify(const Frame& frame, Stage stage, Phase phase, const LightBatch& batch, bool first) {
    const bool rough = phase == Phase::rough;
    const bool counted = stage == Stage::repair || rough;
    SUNFLECK_ASSIGN(
        const gpu::Pipeline* kernel,
        pipeline("classify.comp", {counted, frame.is_held(batch), frame.options.visibility,
                                   rough ? shared::phase_rough : shared::phase_plain, first, batch.light_class}));
    gpu::ComputePass pass(frame.graph, pass_name("tile lists", "repair lists", stage, phase), *kernel);
    pass.storage_read(pixels_)
        .storage_read(nodes_)
        .storage_read(tables_.nodes())
        .storage_read(tables_.rows())
        .storage_write(slots_)
        .storage_write(entries_)
        .storage_write(counts_)
        .storage_read(rough ? rough_commands_ : commands_)
        .storage_write(sums_)
        .storage_read(rough_entries_)
        .uniform(frame.camera)
        .sampled(frame.g_buffer.depth, sampler_)
        .sampled(frame.g_buffer.normals, sampler_)
        .uniform(batch.rows)
        .push(frame.constants);
    dispatch(pass, stage, phase, shared::command_packed, divide_up(frame.constants.group_count, 8));
    return {};
}

Status ManyLight::add_classify_baked(const Frame& frame, Stage stage, const LightBatch& batch) {
    SUNFLECK_ASSIGN(const gpu::Pipeline* kernel, pipeline("classify_baked.comp", {stage == Stage::repair}));
    gpu::ComputePass pass(frame.graph, pass_name("tile lists", "repair lists", stage, Phase::baked), *kernel);
    pass.storage_read(pixels_)
        .storage_read(nodes_)
        .storage_read(tables_.rows())
        .storage_read_write(slots_)
        .storage_write(entries_)
        .storage_write(counts_)
        .storage_read(commands_)
        .uniform(frame.camera)
        .sampled(frame.g_buffer.depth, sampler_)
        .uniform(batch.rows)
        .storage_read(movers_)
        .push(frame.constants);
    dispatch(pass, stage, Phase::baked, shared::command_packed, divide_up(frame.constants.group_count, 8));
    return {};
}

Status ManyLight::add_light(const Frame& frame, Stage stage, Phase phase, const LightBatch& batch, bool last) {
    const bool to_image = last && (stage == Stage::repair || frame.options.scale == 1);
    const std::uint32_t lanes = device_.traits().software ? 8 : 64;
    SUNFLECK_ASSIGN(const gpu::Pipeline* kernel,
                    pipeline("light.comp",
                             {shared::group_pixels / lanes, batch.light_class,
                              frame.options.shadows ? shared::maps_texel_buffer : shared::maps_none,
                              filters_maps(frame.options.filter, batch.light_class), frame.maps.bits(), to_image, lanes,
                              frame.options.stale_maps, std::uint32_t(phase), frame.options.simplified_movers}));
    gpu::ComputePass pass(frame.graph, pass_name("low-resolution light", "repair light", stage, phase), *kernel);
    pass.uniform(frame.camera)
        .sampled(frame.g_buffer.depth, sampler_)
        .sampled(frame.g_buffer.normals, sampler_)
        .uniform(batch.rows)
        .texels(frame.maps.texels() ? frame.maps.texels() : unused_texels_)
        .storage_read(pixels_)
        .storage_read(slots_)
        .storage_read(entries_)
        .storage_read(counts_)
        .storage_read_write(sums_)
        .storage_write(frame.output)
        .texels(phase == Phase::baked ? frame.maps.static_texels() : unused_texels_)
        .storage_read(rough_entries_)
        .push(frame.constants);
    dispatch(pass, stage, phase, shared::command_groups, frame.constants.group_count);
    return {};
}

Status ManyLight::add_reconstruction(const Frame& frame) {
    SUNFLECK_ASSIGN(const gpu::Pipeline* kernel,
                    pipeline("reconstruct.comp", {frame.options.scale, frame.through_buffer}));
    gpu::ComputePass(frame.graph, "reconstruction", *kernel)
        .uniform(frame.camera)
        .sampled(frame.g_buffer.depth, sampler_)
        .sampled(frame.g_buffer.normals, sampler_)
        .texels(sums_)
        .storage_write(frame.output)
        .storage_write(cell_masks_)
        .storage_write(picture_)
        .push(frame.constants)
        .dispatch(divide_up(frame.constants.cell_columns, 8), divide_up(frame.constants.cell_rows, 8));
    if (!frame.through_buffer)
        return {};
    frame.graph.add_pass("reconstruction copy")
        .read(frame.graph.import_buffer(picture_), gpu::Usage::transfer_source)
        .write(frame.output, gpu::Usage::transfer_destination)
        .execute([this, output = frame.output, constants = frame.constants](gpu::PassContext& context) -> Status {
            VkBufferImageCopy region{};
            region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
            region.imageExtent = {constants.width, constants.height, 1};
            context.device.vk.vkCmdCopyBufferToImage(context.commands, picture_.handle(), context.graph.image(output),
                                                     VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region);
            return {};
        });
    return {};
}

Status ManyLight::add_compaction(const Frame& frame) {
    for (std::uint32_t action = 0; action < 3; ++action) {
        SUNFLECK_ASSIGN(const gpu::Pipeline* kernel, pipeline("compact.comp", {action, frame.options.scale, 0u, 0u}));
        gpu::ComputePass(frame.graph, std::string("compaction ") + compaction_steps[action], *kernel)
            .storage_read(cell_masks_)
            .storage_read_write(block_groups_)
            .storage_read_write(commands_)
            .storage_read_write(pixels_)
            .unused(slots_)
            .unused(nodes_)
            .unused(rough_commands_)
            .push(frame.constants)
            .dispatch(action == 1 ? 1 : divide_up(frame.constants.block_count, 8));
    }
    return {};
}

Status ManyLight::add_show(const Frame& frame, std::span<const std::uint32_t> map_ages,
                           gpu::FrameResources& resources) {
    SUNFLECK_ASSIGN(const gpu::Pipeline* kernel, pipeline("show.comp", {frame.options.show}));
    SUNFLECK_ASSIGN(const gpu::UploadSlice ages, resources.upload(map_ages));
    gpu::ComputePass(frame.graph, "false colours", *kernel)
        .storage_read(nodes_)
        .storage_read(tables_.rows())
        .storage_read(counts_)
        .storage_read(sums_)
        .storage_read(cell_masks_)
        .storage_read(ages)
        .storage_write(frame.output)
        .push(frame.constants)
        .dispatch(divide_up(frame.constants.width, 8), divide_up(frame.constants.height, 8));
    return {};
}

// Copies what the compaction counted to where the CPU can read it, frames later.
Status ManyLight::add_counters(const Frame& frame) {
    SUNFLECK_ASSIGN(gpu::ReadbackRing::Slot* const slot,
                    readback_.acquire(completed_serial_, shared::command_words * 4));
    slot->tag = std::uint64_t(frame.constants.low_width) * frame.constants.low_height;
    frame.graph.add_pass("repair counters")
        .read(frame.graph.import_buffer(commands_), gpu::Usage::transfer_source)
        .write(frame.graph.import_buffer(slot->buffer), gpu::Usage::transfer_destination)
        .execute([this, slot](gpu::PassContext& context) -> Status {
            const VkBufferCopy region{0, 0, slot->bytes};
            context.device.vk.vkCmdCopyBuffer(context.commands, commands_.handle(), slot->buffer.handle(), 1, &region);
            return {};
        });
    readback_.add_pass(frame.graph, *slot, serial_);
    return {};
}

} // namespace sunfleck::gi

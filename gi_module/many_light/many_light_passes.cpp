// The passes of the many-light system, in the order of the frame.
#include "engine/core/divide_up.h"
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

// How many groups there are is counted on the GPU for all but the low-resolution picture as a whole.
void ManyLight::dispatch(gpu::ComputePass& pass, const Frame& frame, Phase phase, std::uint32_t command) const {
    if (phase == Phase::rough)
        pass.dispatch_indirect(rough_commands_, VkDeviceSize(command) * 4);
    else
        frame.stage.dispatch(pass, command);
}

// What the pixels of a stage's groups get from all samples.
Status ManyLight::add_lighting(Frame& frame) {
    const auto add = [&](Phase phase, const LightBatch& batch, bool first, bool last) -> Status {
        frame.constants.batch_first = batch.first;
        frame.constants.batch_count = batch.count;
        if (phase == Phase::baked)
            SUNFLECK_TRY(add_classify_baked(frame, batch));
        else
            SUNFLECK_TRY(add_classify(frame, phase, batch, first));
        return add_light(frame, phase, batch, last);
    };
    if (frame.baked) {
        SUNFLECK_TRY(add_rough_list(frame));
        bool first = true;
        for (const LightBatch& batch : batches_)
            if (frame.is_held(batch)) {
                SUNFLECK_TRY(add(Phase::rough, batch, first, false));
                first = false;
            }
    }
    for (std::size_t i = 0; i < batches_.size(); ++i) {
        const Phase phase = frame.baked && frame.is_held(batches_[i]) ? Phase::baked : Phase::plain;
        SUNFLECK_TRY(add(phase, batches_[i], i == 0 && !frame.baked, i + 1 == batches_.size()));
    }
    return {};
}

Status ManyLight::add_gather(const Frame& frame) {
    const bool maps = frame.options.light_maps && frame.options.visibility;
    SUNFLECK_ASSIGN(const gpu::Pipeline* kernel, pipeline("gather.comp", {frame.stage.repair, maps, frame.baked}));
    gpu::ComputePass pass(frame.stage.graph, frame.pass_name("low-resolution pixels", "repair pixels"), *kernel);
    pass.uniform(frame.stage.camera)
        .sampled(frame.stage.g_buffer.depth, sampler_)
        .sampled(frame.stage.g_buffer.normals, sampler_)
        .sampled(frame.stage.g_buffer.surface, sampler_)
        .texels(tables_.instances())
        .texels(tables_.charts())
        .texels(tables_.cells())
        .texels(tables_.nodes())
        .storage_read_write(frame.stage.pixels)
        .storage_write(nodes_)
        .storage_write(frame.stage.sums)
        .storage_read(light_maps_->texels())
        .texels(baked_light_->texels())
        .texels(frame.baked ? baked_light_->curved_rows() : unused_texels_)
        .texels(refined_light_->texels()) // of one format always: some drivers compile a kernel for each
        .storage_write(ratios_)
        .push(frame.constants);
    dispatch(pass, frame, Phase::plain, shared::command_groups);
    return {};
}

// The entries of a stage's groups that did not take baked light, as groups of their own.
Status ManyLight::add_rough_list(Frame& frame) {
    const bool repair = frame.stage.repair;
    frame.constants.entry_blocks = divide_up(repair ? frame.constants.group_capacity : frame.constants.group_count,
                                             shared::pixel_groups_per_block);
    for (std::uint32_t action = 0; action < 3; ++action) {
        SUNFLECK_ASSIGN(const gpu::Pipeline* kernel, pipeline("rough_entries.comp", {action, repair}));
        const std::string name = repair ? "repair rough pixels " : "rough pixels ";
        gpu::ComputePass(frame.stage.graph, name + compaction_steps[action], *kernel)
            .storage_read_write(block_groups_)
            .storage_read_write(rough_commands_)
            .storage_read_write(rough_entries_)
            .storage_read(frame.stage.pixels)
            .storage_read(nodes_)
            .storage_read(frame.stage.commands)
            .push(frame.constants)
            .dispatch(action == 1 ? 1 : divide_up(frame.constants.entry_blocks, 8));
    }
    return {};
}

Status ManyLight::add_classify(const Frame& frame, Phase phase, const LightBatch& batch, bool first) {
    const bool rough = phase == Phase::rough;
    const bool counted = frame.stage.repair || rough;
    SUNFLECK_ASSIGN(
        const gpu::Pipeline* kernel,
        pipeline("classify.comp", {counted, frame.is_held(batch), frame.options.visibility,
                                   rough ? shared::phase_rough : shared::phase_plain, first, batch.light_class}));
    gpu::ComputePass pass(frame.stage.graph, frame.pass_name("tile lists", "repair lists", phase), *kernel);
    pass.storage_read(frame.stage.pixels)
        .storage_read(nodes_)
        .storage_read(tables_.nodes())
        .storage_read(tables_.rows())
        .storage_write(local_nodes_)
        .storage_write(entries_)
        .storage_write(counts_)
        .storage_read(rough ? rough_commands_ : frame.stage.commands)
        .storage_write(frame.stage.sums)
        .storage_read(rough_entries_)
        .uniform(frame.stage.camera)
        .sampled(frame.stage.g_buffer.depth, sampler_)
        .sampled(frame.stage.g_buffer.normals, sampler_)
        .uniform(batch.rows)
        .push(frame.constants);
    dispatch(pass, frame, phase, shared::command_packed);
    return {};
}

Status ManyLight::add_classify_baked(const Frame& frame, const LightBatch& batch) {
    SUNFLECK_ASSIGN(const gpu::Pipeline* kernel, pipeline("classify_baked.comp", {frame.stage.repair}));
    gpu::ComputePass pass(frame.stage.graph, frame.pass_name("tile lists", "repair lists", Phase::baked), *kernel);
    pass.storage_read(frame.stage.pixels)
        .storage_read(nodes_)
        .storage_read(tables_.rows())
        .storage_read_write(local_nodes_)
        .storage_write(entries_)
        .storage_write(counts_)
        .storage_read(frame.stage.commands)
        .uniform(frame.stage.camera)
        .sampled(frame.stage.g_buffer.depth, sampler_)
        .uniform(batch.rows)
        .storage_read(movers_)
        .push(frame.constants);
    dispatch(pass, frame, Phase::baked, shared::command_packed);
    return {};
}

Status ManyLight::add_light(const Frame& frame, Phase phase, const LightBatch& batch, bool last) {
    const bool to_image = last && frame.stage.last && frame.stage.resolves;
    const std::uint32_t lanes = device_.traits().software ? 8 : 64;
    SUNFLECK_ASSIGN(const gpu::Pipeline* kernel,
                    pipeline("light.comp",
                             {shared::pixel_group_size / lanes, batch.light_class,
                              frame.options.shadows ? shared::maps_texel_buffer : shared::maps_none,
                              filters_maps(frame.options.filter, batch.light_class), frame.maps.bits(), to_image, lanes,
                              frame.options.stale_maps, std::uint32_t(phase), frame.options.simplified_movers}));
    gpu::ComputePass pass(frame.stage.graph, frame.pass_name("low-resolution light", "repair light", phase), *kernel);
    pass.uniform(frame.stage.camera)
        .sampled(frame.stage.g_buffer.depth, sampler_)
        .sampled(frame.stage.g_buffer.normals, sampler_)
        .uniform(batch.rows)
        .texels(frame.maps.texels() ? frame.maps.texels() : unused_words_)
        .storage_read(frame.stage.pixels)
        .storage_read(local_nodes_)
        .storage_read(entries_)
        .storage_read(counts_)
        .storage_read_write(frame.stage.sums)
        .storage_write(frame.stage.output)
        .texels(phase == Phase::baked ? frame.maps.static_texels() : unused_words_)
        .storage_read(rough_entries_)
        .storage_read(ratios_)
        .push(frame.constants);
    dispatch(pass, frame, phase, shared::command_groups);
    return {};
}

Status ManyLight::add_show(const Frame& frame, gpu::FrameResources& resources) {
    SUNFLECK_ASSIGN(const gpu::Pipeline* kernel, pipeline("show.comp", {frame.options.show}));
    SUNFLECK_ASSIGN(const gpu::UploadSlice ages, resources.upload(std::span<const std::uint32_t>(map_ages_)));
    gpu::ComputePass(frame.stage.graph, "false colours", *kernel)
        .storage_read(nodes_)
        .storage_read(tables_.rows())
        .storage_read(counts_)
        .storage_read(frame.stage.sums)
        .storage_read(frame.stage.cell_masks)
        .storage_read(ages)
        .storage_write(frame.stage.output)
        .push(frame.constants)
        .dispatch(divide_up(frame.constants.width, 8), divide_up(frame.constants.height, 8));
    return {};
}

} // namespace sunfleck::gi

// The passes of the many-light system, in the order of the frame.
#include "gi_module/many_light/many_light_frame.h"

#include "gi_module/shadows/octahedral_map.h"

namespace sunfleck::gi {

using enum gpu::BindingKind;

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

void ManyLight::dispatch(gpu::PassContext& context, Stage stage, Phase phase, std::uint32_t command,
                         std::uint32_t groups) const {
    const gpu::Buffer& counted = phase == Phase::rough ? rough_commands_ : commands_;
    if (stage == Stage::repair || phase == Phase::rough)
        context.device.vk.vkCmdDispatchIndirect(context.commands, counted.handle(), VkDeviceSize(command) * 4);
    else
        context.device.vk.vkCmdDispatch(context.commands, groups, 1, 1);
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
    SUNFLECK_ASSIGN(const gpu::Pipeline* kernel,
                    pipeline("gather.comp",
                             {uniform_buffer, sampled_image, sampled_image, sampled_image, texel_buffer, texel_buffer,
                              texel_buffer, texel_buffer, storage_buffer, storage_buffer, storage_buffer,
                              storage_buffer, texel_buffer, texel_buffer},
                             {stage == Stage::repair, maps, frame.baked}));
    const gpu::Buffer& curved_rows = frame.baked ? baked_light_->curved_rows() : unused_texels_;
    auto pass = frame.graph.add_pass(stage == Stage::repair ? "repair" : "low-resolution pixels");
    if (stage == Stage::repair)
        pass.read(frame.commands, gpu::Usage::indirect_read);
    pass.read(frame.g_buffer.depth, gpu::Usage::sampled)
        .read(frame.g_buffer.normals, gpu::Usage::sampled)
        .read(frame.g_buffer.surface, gpu::Usage::sampled);
    for (const gpu::Buffer* table : {&tables_.instances(), &tables_.charts(), &tables_.cells(), &tables_.nodes(),
                                     &baked_light_->texels(), &curved_rows})
        pass.read(frame.graph.import_buffer(*table), gpu::Usage::texel_read);
    pass.read(frame.graph.import_buffer(light_maps_->texels()), gpu::Usage::storage_read)
        .write(frame.pixels, gpu::Usage::storage_read_write)
        .write(frame.nodes, gpu::Usage::storage_write)
        .write(frame.sums, gpu::Usage::storage_write)
        .execute([this, kernel, stage, &curved_rows, camera = frame.camera, g_buffer = frame.g_buffer,
                  constants = frame.constants](gpu::PassContext& context) -> Status {
            const gpu::Binding bindings[] = {
                gpu::Binding::slice(camera),
                gpu::Binding::sampled_image(context.graph.view(g_buffer.depth), sampler_),
                gpu::Binding::sampled_image(context.graph.view(g_buffer.normals), sampler_),
                gpu::Binding::sampled_image(context.graph.view(g_buffer.surface), sampler_),
                gpu::Binding::texels(tables_.instances()),
                gpu::Binding::texels(tables_.charts()),
                gpu::Binding::texels(tables_.cells()),
                gpu::Binding::texels(tables_.nodes()),
                gpu::Binding::buffer(pixels_),
                gpu::Binding::buffer(nodes_),
                gpu::Binding::buffer(sums_),
                gpu::Binding::buffer(light_maps_->texels()),
                gpu::Binding::texels(baked_light_->texels()),
                gpu::Binding::texels(curved_rows)};
            SUNFLECK_TRY(context.resources.bind(context.commands, *kernel, bindings));
            context.resources.push(context.commands, *kernel, constants);
            dispatch(context, stage, Phase::plain, shared::command_groups, constants.group_count);
            return {};
        });
    return {};
}

// The entries of a stage's groups that did not take baked light, as groups of their own.
Status ManyLight::add_rough_list(Frame& frame, Stage stage) {
    const bool repair = stage == Stage::repair;
    frame.constants.entry_blocks =
        divide_up(repair ? frame.constants.group_capacity : frame.constants.group_count, shared::groups_per_block);
    for (std::uint32_t action = 0; action < 3; ++action) {
        SUNFLECK_ASSIGN(const gpu::Pipeline* kernel, pipeline("compact.comp", std::vector(7, storage_buffer),
                                                              {action, frame.options.scale, 1u, repair}));
        frame.graph.add_pass(repair ? "repair" : "tiles")
            .read(frame.commands, gpu::Usage::storage_read)
            .read(frame.pixels, gpu::Usage::storage_read)
            .read(frame.nodes, gpu::Usage::storage_read)
            .write(frame.block_groups, gpu::Usage::storage_read_write)
            .write(frame.rough_commands, gpu::Usage::storage_read_write)
            .write(frame.rough_entries, gpu::Usage::storage_read_write)
            .execute([this, kernel, action, constants = frame.constants](gpu::PassContext& context) -> Status {
                const gpu::Binding bindings[] = {
                    gpu::Binding::buffer(cell_masks_),     gpu::Binding::buffer(block_groups_),
                    gpu::Binding::buffer(rough_commands_), gpu::Binding::buffer(rough_entries_),
                    gpu::Binding::buffer(pixels_),         gpu::Binding::buffer(nodes_),
                    gpu::Binding::buffer(commands_)};
                SUNFLECK_TRY(context.resources.bind(context.commands, *kernel, bindings));
                context.resources.push(context.commands, *kernel, constants);
                context.device.vk.vkCmdDispatch(context.commands,
                                                action == 1 ? 1 : divide_up(constants.entry_blocks, 8), 1, 1);
                return {};
            });
    }
    return {};
}

Status ManyLight::add_classify(const Frame& frame, Stage stage, Phase phase, const LightBatch& batch, bool first) {
    const bool rough = phase == Phase::rough;
    const bool counted = stage == Stage::repair || rough;
    SUNFLECK_ASSIGN(const gpu::Pipeline* kernel,
                    pipeline("classify.comp",
                             {storage_buffer, storage_buffer, storage_buffer, storage_buffer, storage_buffer,
                              storage_buffer, storage_buffer, storage_buffer, storage_buffer, storage_buffer,
                              uniform_buffer, sampled_image, sampled_image, uniform_buffer},
                             {counted, frame.is_held(batch), frame.options.visibility,
                              rough ? shared::phase_rough : shared::phase_plain, first, batch.light_class}));
    auto pass = frame.graph.add_pass(stage == Stage::repair ? "repair" : "tiles");
    const gpu::ResourceId commands = rough ? frame.rough_commands : frame.commands;
    if (counted)
        pass.read(commands, gpu::Usage::indirect_read);
    for (const gpu::ResourceId list : {commands, frame.pixels, frame.nodes, frame.rough_entries})
        pass.read(list, gpu::Usage::storage_read);
    pass.read(frame.g_buffer.depth, gpu::Usage::sampled)
        .read(frame.g_buffer.normals, gpu::Usage::sampled)
        .read(frame.graph.import_buffer(tables_.nodes()), gpu::Usage::storage_read)
        .read(frame.graph.import_buffer(tables_.rows()), gpu::Usage::storage_read)
        .write(frame.slots, gpu::Usage::storage_write)
        .write(frame.entries, gpu::Usage::storage_write)
        .write(frame.counts, gpu::Usage::storage_write)
        .write(frame.sums, gpu::Usage::storage_write)
        .execute([this, kernel, stage, phase, batch, camera = frame.camera, g_buffer = frame.g_buffer,
                  constants = frame.constants](gpu::PassContext& context) -> Status {
            const gpu::Binding bindings[] = {
                gpu::Binding::buffer(pixels_),
                gpu::Binding::buffer(nodes_),
                gpu::Binding::buffer(tables_.nodes()),
                gpu::Binding::buffer(tables_.rows()),
                gpu::Binding::buffer(slots_),
                gpu::Binding::buffer(entries_),
                gpu::Binding::buffer(counts_),
                gpu::Binding::buffer(phase == Phase::rough ? rough_commands_ : commands_),
                gpu::Binding::buffer(sums_),
                gpu::Binding::buffer(rough_entries_),
                gpu::Binding::slice(camera),
                gpu::Binding::sampled_image(context.graph.view(g_buffer.depth), sampler_),
                gpu::Binding::sampled_image(context.graph.view(g_buffer.normals), sampler_),
                gpu::Binding::slice(batch.rows)};
            SUNFLECK_TRY(context.resources.bind(context.commands, *kernel, bindings));
            context.resources.push(context.commands, *kernel, constants);
            dispatch(context, stage, phase, shared::command_packed, divide_up(constants.group_count, 8));
            return {};
        });
    return {};
}

Status ManyLight::add_classify_baked(const Frame& frame, Stage stage, const LightBatch& batch) {
    SUNFLECK_ASSIGN(
        const gpu::Pipeline* kernel,
        pipeline("classify_baked.comp",
                 {storage_buffer, storage_buffer, storage_buffer, storage_buffer, storage_buffer, storage_buffer,
                  storage_buffer, uniform_buffer, sampled_image, uniform_buffer, storage_buffer},
                 {stage == Stage::repair}));
    auto pass = frame.graph.add_pass(stage == Stage::repair ? "repair" : "tiles");
    if (stage == Stage::repair)
        pass.read(frame.commands, gpu::Usage::indirect_read);
    for (const gpu::ResourceId list : {frame.commands, frame.pixels, frame.nodes})
        pass.read(list, gpu::Usage::storage_read);
    pass.read(frame.graph.import_buffer(tables_.rows()), gpu::Usage::storage_read)
        .read(frame.g_buffer.depth, gpu::Usage::sampled)
        .write(frame.slots, gpu::Usage::storage_read_write)
        .write(frame.entries, gpu::Usage::storage_write)
        .write(frame.counts, gpu::Usage::storage_write)
        .execute([this, kernel, stage, batch, camera = frame.camera, g_buffer = frame.g_buffer,
                  constants = frame.constants](gpu::PassContext& context) -> Status {
            const gpu::Binding bindings[] = {gpu::Binding::buffer(pixels_),
                                             gpu::Binding::buffer(nodes_),
                                             gpu::Binding::buffer(tables_.rows()),
                                             gpu::Binding::buffer(slots_),
                                             gpu::Binding::buffer(entries_),
                                             gpu::Binding::buffer(counts_),
                                             gpu::Binding::buffer(commands_),
                                             gpu::Binding::slice(camera),
                                             gpu::Binding::sampled_image(context.graph.view(g_buffer.depth), sampler_),
                                             gpu::Binding::slice(batch.rows),
                                             gpu::Binding::slice(movers_)};
            SUNFLECK_TRY(context.resources.bind(context.commands, *kernel, bindings));
            context.resources.push(context.commands, *kernel, constants);
            dispatch(context, stage, Phase::baked, shared::command_packed, divide_up(constants.group_count, 8));
            return {};
        });
    return {};
}

Status ManyLight::add_light(const Frame& frame, Stage stage, Phase phase, const LightBatch& batch, bool last) {
    const bool to_image = last && (stage == Stage::repair || frame.options.scale == 1);
    const std::uint32_t lanes = device_.traits().software ? 8 : 64;
    SUNFLECK_ASSIGN(const gpu::Pipeline* kernel,
                    pipeline("light.comp",
                             {uniform_buffer, sampled_image, sampled_image, uniform_buffer, texel_buffer,
                              storage_buffer, storage_buffer, storage_buffer, storage_buffer, storage_buffer,
                              storage_image, texel_buffer, storage_buffer},
                             {shared::group_pixels / lanes, batch.light_class,
                              frame.options.shadows ? shared::maps_texel_buffer : shared::maps_none,
                              filters_maps(frame.options.filter, batch.light_class), frame.maps.bits(), to_image, lanes,
                              frame.options.stale_maps, std::uint32_t(phase), frame.options.simplified_movers}));
    auto pass = frame.graph.add_pass(stage == Stage::repair ? "repair" : "low-resolution light");
    if (stage == Stage::repair || phase == Phase::rough)
        pass.read(phase == Phase::rough ? frame.rough_commands : frame.commands, gpu::Usage::indirect_read);
    if (phase == Phase::baked)
        pass.read(frame.graph.import_buffer(frame.maps.static_texels()), gpu::Usage::texel_read);
    if (frame.maps.texels())
        pass.read(frame.graph.import_buffer(frame.maps.texels()), gpu::Usage::texel_read);
    pass.read(frame.g_buffer.depth, gpu::Usage::sampled).read(frame.g_buffer.normals, gpu::Usage::sampled);
    for (const gpu::ResourceId list : {frame.pixels, frame.slots, frame.entries, frame.counts, frame.rough_entries})
        pass.read(list, gpu::Usage::storage_read);
    pass.write(frame.sums, gpu::Usage::storage_read_write)
        .write(frame.output, gpu::Usage::storage_write)
        .execute([this, kernel, stage, phase, batch, camera = frame.camera, g_buffer = frame.g_buffer,
                  output = frame.output, &maps = frame.maps,
                  constants = frame.constants](gpu::PassContext& context) -> Status {
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
                gpu::Binding::storage_image(context.graph.view(output)),
                gpu::Binding::texels(phase == Phase::baked ? maps.static_texels() : unused_texels_),
                gpu::Binding::buffer(rough_entries_)};
            SUNFLECK_TRY(context.resources.bind(context.commands, *kernel, bindings));
            context.resources.push(context.commands, *kernel, constants);
            dispatch(context, stage, phase, shared::command_groups, constants.group_count);
            return {};
        });
    return {};
}

Status ManyLight::add_reconstruction(const Frame& frame) {
    SUNFLECK_ASSIGN(const gpu::Pipeline* kernel, pipeline("reconstruct.comp",
                                                          {uniform_buffer, sampled_image, sampled_image, texel_buffer,
                                                           storage_image, storage_buffer, storage_buffer},
                                                          {frame.options.scale, frame.through_buffer}));
    const gpu::ResourceId picture = frame.graph.import_buffer(picture_);
    frame.graph.add_pass("reconstruction")
        .read(frame.g_buffer.depth, gpu::Usage::sampled)
        .read(frame.g_buffer.normals, gpu::Usage::sampled)
        .read(frame.sums, gpu::Usage::texel_read)
        .write(frame.output, gpu::Usage::storage_write)
        .write(picture, gpu::Usage::storage_write)
        .write(frame.cell_masks, gpu::Usage::storage_write)
        .execute([this, kernel, camera = frame.camera, g_buffer = frame.g_buffer, output = frame.output,
                  constants = frame.constants](gpu::PassContext& context) -> Status {
            const gpu::Binding bindings[] = {
                gpu::Binding::slice(camera),
                gpu::Binding::sampled_image(context.graph.view(g_buffer.depth), sampler_),
                gpu::Binding::sampled_image(context.graph.view(g_buffer.normals), sampler_),
                gpu::Binding::texels(sums_),
                gpu::Binding::storage_image(context.graph.view(output)),
                gpu::Binding::buffer(cell_masks_),
                gpu::Binding::buffer(picture_)};
            SUNFLECK_TRY(context.resources.bind(context.commands, *kernel, bindings));
            context.resources.push(context.commands, *kernel, constants);
            context.device.vk.vkCmdDispatch(context.commands, divide_up(constants.cell_columns, 8),
                                            divide_up(constants.cell_rows, 8), 1);
            return {};
        });
    if (!frame.through_buffer)
        return {};
    frame.graph.add_pass("reconstruction")
        .read(picture, gpu::Usage::transfer_source)
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
        SUNFLECK_ASSIGN(const gpu::Pipeline* kernel, pipeline("compact.comp", std::vector(7, storage_buffer),
                                                              {action, frame.options.scale, 0u, 0u}));
        frame.graph.add_pass("compaction")
            .read(frame.cell_masks, gpu::Usage::storage_read)
            .write(frame.block_groups, gpu::Usage::storage_read_write)
            .write(frame.commands, gpu::Usage::storage_read_write)
            .write(frame.pixels, gpu::Usage::storage_read_write)
            .execute([this, kernel, action, constants = frame.constants](gpu::PassContext& context) -> Status {
                const gpu::Binding bindings[] = {
                    gpu::Binding::buffer(cell_masks_),    gpu::Binding::buffer(block_groups_),
                    gpu::Binding::buffer(commands_),      gpu::Binding::buffer(pixels_),
                    gpu::Binding::buffer(slots_),         gpu::Binding::buffer(nodes_),
                    gpu::Binding::buffer(rough_commands_)};
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

} // namespace sunfleck::gi

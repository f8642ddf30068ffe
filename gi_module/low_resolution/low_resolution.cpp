#include "gi_module/low_resolution/low_resolution.h"

#include "engine/core/divide_up.h"

#include <algorithm>

namespace sunfleck::gi {
namespace {

constexpr std::uint64_t repair_memory = std::uint64_t(24) << 20; // B, bound of contributors' memory for repaired groups
constexpr std::uint32_t min_repair_fraction = 4;                 // a quarter of the picture, where that fits
constexpr std::uint64_t small_picture_groups = 512;              // all of a picture of 32,768 pixels

constexpr const char* compaction_steps[] = {"count", "offsets", "list"};

constexpr Counter low_pixels{"pixels_low_resolution", "pixels", "pixels", "Pixels lit at low resolution", true};
constexpr Counter repaired{"pixels_repaired", "pixels", "pixels", "Pixels lit again at full resolution", true};
constexpr Counter not_repaired{"pixels_not_repaired", "pixels", "pixels",
                               "Pixels that needed repair, but took their nearest neighbour's light: memory was full",
                               true};
constexpr Counter memory{"low_resolution", "B", memory_group, "Lists and sums of pixels on the GPU"};

shared::LowResolutionConstants make_constants(const LowResolutionSettings& settings, const LowResolutionFrame& frame) {
    shared::LowResolutionConstants constants{};
    constants.width = frame.g_buffer.width;
    constants.height = frame.g_buffer.height;
    constants.scale = frame.every_pixel ? 1 : settings.low_resolution;
    constants.low_width = divide_up(constants.width, constants.scale);
    constants.low_height = divide_up(constants.height, constants.scale);
    constants.group_columns = divide_up(constants.low_width, shared::pixel_group_side);
    constants.group_count = constants.group_columns * divide_up(constants.low_height, shared::pixel_group_side);
    constants.cell_columns = constants.low_width + 1;
    constants.cell_rows = constants.low_height + 1;
    constants.block_columns = divide_up(constants.cell_columns, 8);
    constants.block_count = constants.block_columns * divide_up(constants.cell_rows, 8);
    constants.contrast = settings.repair_contrast;
    // A radian is 0.64 (about an axis) to 1.04 (between axes) octahedral units; the smaller, so that none is missed.
    const float limit = 0.64f * glm::radians(settings.repair_angle);
    constants.normal_limit = limit * limit;
    const std::uint64_t whole = divide_up(constants.width * constants.height, shared::pixel_group_size);
    constants.group_capacity = std::uint32_t(
        std::clamp<std::uint64_t>(std::max(whole / min_repair_fraction, std::min(whole, small_picture_groups)), 64,
                                  std::max<std::uint64_t>(repair_memory / frame.bytes_per_group, 64)));
    return constants;
}

} // namespace

void PixelStage::dispatch(gpu::ComputePass& pass, std::uint32_t command) const {
    if (repair)
        pass.dispatch_indirect(commands, VkDeviceSize(command) * 4);
    else
        pass.dispatch(command == shared::command_packed ? divide_up(constants.group_count, 8) : constants.group_count);
}

std::span<const Counter> LowResolution::counters() {
    static const Counter all[] = {low_pixels, repaired, not_repaired, memory};
    return all;
}

void LowResolution::report(Report& report) const {
    report.set(low_pixels, double(low_pixels_));
    report.set(repaired, double(repaired_));
    report.set(not_repaired, double(not_repaired_));
    double bytes = 0.0;
    for (const gpu::Buffer* buffer : {&pixels_, &sums_, &cell_masks_, &block_entries_, &commands_, &picture_})
        bytes += double(buffer->size());
    report.set(memory, bytes);
}

Result<std::unique_ptr<LowResolution>> LowResolution::create(gpu::Device& device, gpu::PipelineStore& pipelines) {
    std::unique_ptr<LowResolution> result(new LowResolution(device, pipelines));
    VkSamplerCreateInfo sampler{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
    SUNFLECK_VK(device.vk.vkCreateSampler(device.handle(), &sampler, nullptr, &result->sampler_), "creating a sampler");
    return result;
}

LowResolution::~LowResolution() {
    device_.vk.vkDestroySampler(device_.handle(), sampler_, nullptr);
}

Status LowResolution::make_buffer(gpu::Buffer& buffer, const char* name, std::uint64_t bytes, VkBufferUsageFlags usage,
                                  gpu::FrameResources& resources, VkFormat texel_format) {
    if (buffer && buffer.size() >= bytes)
        return {};
    if (const std::uint64_t most = device_.traits().max_storage_range; bytes > most)
        return Error{"this picture needs " + std::to_string(bytes >> 20) + " MiB for '" + name +
                         "', but the device binds buffers of at most " + std::to_string(most >> 20) +
                         " MiB: raise low_resolution or draw fewer pixels",
                     ErrorCode::memory};
    if (buffer)
        resources.retire(std::move(buffer));
    SUNFLECK_ASSIGN(buffer, gpu::Buffer::create(device_, {name, bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | usage,
                                                          gpu::MemoryUse::device, texel_format}));
    return {};
}

Status LowResolution::make_buffers(const shared::LowResolutionConstants& constants, gpu::FrameResources& resources) {
    const std::uint64_t groups = std::max(constants.group_capacity, constants.group_count);
    const std::uint64_t entries = groups * shared::pixel_group_size;
    SUNFLECK_TRY(make_buffer(pixels_, "pixels of groups", entries * 4, 0, resources));
    SUNFLECK_TRY(make_buffer(sums_, "sums of groups", entries * 16, VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT, resources,
                             VK_FORMAT_R32G32B32A32_SFLOAT));
    SUNFLECK_TRY(make_buffer(cell_masks_, "repair masks",
                             std::uint64_t(constants.cell_columns) * constants.cell_rows * 8, 0, resources));
    SUNFLECK_TRY(make_buffer(block_entries_, "repair blocks", std::uint64_t(constants.block_count) * 4, 0, resources));
    return make_buffer(commands_, "repair commands", shared::command_words * 4,
                       VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT, resources);
}

Result<const gpu::Pipeline*> LowResolution::pipeline(const char* shader, std::vector<std::uint32_t> specialization) {
    gpu::ComputeDescription description;
    description.shader = std::string("gi_module/low_resolution/") + shader;
    description.specialization = std::move(specialization);
    return pipelines_.compute(description);
}

Status LowResolution::light_stage(PixelStage stage, std::span<const PixelLighting> contributors) {
    for (std::size_t i = 0; i < contributors.size(); ++i) {
        stage.first = i == 0;
        stage.last = i + 1 == contributors.size();
        SUNFLECK_TRY(contributors[i](stage));
    }
    return {};
}

Status LowResolution::add_passes(gpu::FrameGraph& graph, const LowResolutionSettings& settings,
                                 const LowResolutionFrame& frame, std::span<const PixelLighting> contributors,
                                 gpu::FrameResources& resources) {
    const shared::LowResolutionConstants constants = make_constants(settings, frame);
    SUNFLECK_TRY(make_buffers(constants, resources));
    const bool reconstructs = constants.scale > 1;
    const std::uint64_t picture_bytes = std::uint64_t(constants.width) * constants.height * 8;
    // A CPU device stores to buffers much faster than to images.
    const bool through_buffer = reconstructs && device_.traits().software && !graph.owned_by_host(frame.output) &&
                                graph.description(frame.output).format == VK_FORMAT_R16G16B16A16_SFLOAT &&
                                picture_bytes <= device_.traits().max_storage_range;
    SUNFLECK_TRY(make_buffer(picture_, "reconstructed picture", through_buffer ? picture_bytes : 8,
                             VK_BUFFER_USAGE_TRANSFER_SRC_BIT, resources));
    PixelStage stage{*this, graph,         frame.g_buffer, frame.camera, constants, false,       true,
                     true,  !reconstructs, pixels_,        sums_,        commands_, cell_masks_, frame.output};
    SUNFLECK_TRY(light_stage(stage, contributors));
    if (!reconstructs) {
        low_pixels_ = repaired_ = not_repaired_ = 0;
        return {};
    }
    SUNFLECK_TRY(add_reconstruction(stage, through_buffer, settings.repair_contacts));
    SUNFLECK_TRY(add_compaction(stage));
    stage.repair = stage.resolves = true;
    SUNFLECK_TRY(light_stage(stage, contributors));
    return add_counters(stage, frame);
}

Status LowResolution::add_reconstruction(const PixelStage& stage, bool through_buffer, bool repairs_contacts) {
    SUNFLECK_ASSIGN(const gpu::Pipeline* kernel,
                    pipeline("reconstruct.comp", {stage.constants.scale, through_buffer, repairs_contacts}));
    gpu::ComputePass(stage.graph, "reconstruction", *kernel)
        .uniform(stage.camera)
        .sampled(stage.g_buffer.depth, sampler_)
        .sampled(stage.g_buffer.normals, sampler_)
        .texels(sums_)
        .storage_write(stage.output)
        .storage_write(cell_masks_)
        .storage_write(picture_)
        .push(stage.constants)
        .dispatch(divide_up(stage.constants.cell_columns, 8), divide_up(stage.constants.cell_rows, 8));
    if (!through_buffer)
        return {};
    stage.graph.add_pass("reconstruction copy")
        .read(stage.graph.import_buffer(picture_), gpu::Usage::transfer_source)
        .write(stage.output, gpu::Usage::transfer_destination)
        .execute([this, output = stage.output, constants = stage.constants](gpu::PassContext& context) -> Status {
            VkBufferImageCopy region{};
            region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
            region.imageExtent = {constants.width, constants.height, 1};
            context.device.vk.vkCmdCopyBufferToImage(context.commands, picture_.handle(), context.graph.image(output),
                                                     VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region);
            return {};
        });
    return {};
}

Status LowResolution::add_compaction(const PixelStage& stage) {
    for (std::uint32_t action = 0; action < 3; ++action) {
        SUNFLECK_ASSIGN(const gpu::Pipeline* kernel, pipeline("compact.comp", {action, stage.constants.scale}));
        gpu::ComputePass(stage.graph, std::string("compaction ") + compaction_steps[action], *kernel)
            .storage_read(cell_masks_)
            .storage_read_write(block_entries_)
            .storage_read_write(commands_)
            .storage_write(pixels_)
            .push(stage.constants)
            .dispatch(action == 1 ? 1 : divide_up(stage.constants.block_count, 8));
    }
    return {};
}

// Copies what the compaction counted to where the CPU can read it, frames later.
Status LowResolution::add_counters(const PixelStage& stage, const LowResolutionFrame& frame) {
    if (const gpu::ReadbackRing::Slot* done = readback_.collect(frame.completed_serial)) {
        const auto words = gpu::ReadbackRing::content<std::uint32_t>(*done);
        low_pixels_ = done->tag;
        repaired_ = words[shared::command_totals + 1];
        not_repaired_ = words[shared::command_totals] - words[shared::command_totals + 1];
    }
    SUNFLECK_ASSIGN(gpu::ReadbackRing::Slot* const slot,
                    readback_.acquire(frame.completed_serial, shared::command_words * 4));
    slot->tag = std::uint64_t(stage.constants.low_width) * stage.constants.low_height;
    stage.graph.add_pass("repair counters")
        .read(stage.graph.import_buffer(commands_), gpu::Usage::transfer_source)
        .write(stage.graph.import_buffer(slot->buffer), gpu::Usage::transfer_destination)
        .execute([this, slot](gpu::PassContext& context) -> Status {
            const VkBufferCopy region{0, 0, slot->bytes};
            context.device.vk.vkCmdCopyBuffer(context.commands, commands_.handle(), slot->buffer.handle(), 1, &region);
            return {};
        });
    readback_.add_pass(stage.graph, *slot, frame.serial);
    return {};
}

Status LowResolution::list_pixels(const PixelStage& stage) {
    SUNFLECK_ASSIGN(const gpu::Pipeline* kernel, pipeline("list_pixels.comp", {stage.repair}));
    gpu::ComputePass pass(stage.graph, stage.repair ? "repair pixels" : "low-resolution pixels", *kernel);
    pass.sampled(stage.g_buffer.depth, sampler_).storage_read_write(pixels_).storage_write(sums_).push(stage.constants);
    stage.dispatch(pass, shared::command_groups);
    return {};
}

Status LowResolution::resolve(const PixelStage& stage) {
    SUNFLECK_ASSIGN(const gpu::Pipeline* kernel, pipeline("resolve.comp", {}));
    gpu::ComputePass pass(stage.graph, stage.repair ? "repair resolve" : "light resolve", *kernel);
    pass.storage_read(pixels_).storage_read(sums_).storage_write(stage.output).push(stage.constants);
    stage.dispatch(pass, shared::command_groups);
    return {};
}

} // namespace sunfleck::gi

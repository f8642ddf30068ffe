#include "gi_module/brute_force/brute_force.h"

#include "engine/core/divide_up.h"
#include "engine/gpu/compute_pass.h"

#include <algorithm>

namespace sunfleck::gi {
namespace {

std::uint32_t group_columns(std::uint32_t width, std::uint32_t pixels) {
    return divide_up(width, shared::kernel_lanes * pixels);
}

std::uint32_t group_rows(std::uint32_t height) {
    return divide_up(height, shared::kernel_rows);
}

} // namespace

Result<std::unique_ptr<BruteForce>> BruteForce::create(gpu::Device& device, gpu::PipelineStore& pipelines) {
    std::unique_ptr<BruteForce> technique(new BruteForce(device, pipelines));
    technique->shape_ = default_shape(device.traits());
    VkSamplerCreateInfo sampler{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
    SUNFLECK_VK(device.vk.vkCreateSampler(device.handle(), &sampler, nullptr, &technique->sampler_),
                "creating a sampler");
    // Some drivers need every binding of a set to be alive, used or not.
    gpu::BufferDescription unused;
    unused.name = "unused texels";
    unused.usage = VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
    unused.texel_format = VK_FORMAT_R32_UINT;
    SUNFLECK_ASSIGN(technique->unused_texels_, gpu::Buffer::create(device, unused));
    return technique;
}

BruteForce::~BruteForce() {
    device_.vk.vkDestroySampler(device_.handle(), sampler_, nullptr);
}

KernelShape BruteForce::default_shape(const gpu::DeviceTraits& traits) {
    KernelShape shape;
    // On a CPU the light's loads cost as much as its arithmetic and are shared by an invocation's pixels; a GPU wants
    // many small invocations instead.
    shape.pixels = traits.software ? 16 : 1;
    return shape;
}

std::uint32_t BruteForce::band_rows(std::uint32_t width) const {
    const std::uint64_t rows = device_.traits().max_storage_range / (std::uint64_t(width) * sizeof(vec4));
    // A multiple of 16 rows keeps the offsets of bands on every device's alignment (16 rows x 16 bytes = 256).
    return std::uint32_t(std::clamp<std::uint64_t>(rows / 16 * 16, 16, 1u << 20));
}

void BruteForce::collect(std::uint64_t completed_serial) {
    const gpu::ReadbackRing::Slot* const slot = readback_.collect(completed_serial);
    if (slot == nullptr)
        return;
    double flux = 0, irradiance = 0, pixels = 0;
    for (const vec4& group : gpu::ReadbackRing::content<vec4>(*slot)) {
        flux += double(group.x);
        irradiance += double(group.y);
        pixels += double(group.z);
    }
    clamped_ = {flux, pixels > 0 ? irradiance / pixels : 0.0, slot->serial};
}

Status BruteForce::begin_frame(std::uint32_t width, std::uint32_t height, bool accumulates, std::uint64_t serial,
                               std::uint64_t completed_serial, gpu::FrameResources& resources) {
    serial_ = serial;
    collect(completed_serial);
    const VkDeviceSize bytes = accumulates ? VkDeviceSize(width) * height * sizeof(vec4) : 16;
    if (!accumulation_ || accumulation_.size() < bytes) {
        if (accumulation_)
            resources.retire(std::move(accumulation_));
        SUNFLECK_ASSIGN(accumulation_,
                        gpu::Buffer::create(device_, {"irradiance sums", bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                                                      gpu::MemoryUse::device, VK_FORMAT_UNDEFINED}));
    }
    const std::uint32_t groups = group_columns(width, shape_.pixels) * group_rows(height);
    SUNFLECK_ASSIGN(clamped_sums_, readback_.acquire(completed_serial, groups * sizeof(vec4)));
    return {};
}

Result<const gpu::Pipeline*> BruteForce::pipeline(std::uint32_t light_class, const BruteForceOptions& options,
                                                  std::uint32_t map_bits) {
    gpu::ComputeDescription description;
    description.shader = "gi_module/brute_force/brute_force.comp";
    description.specialization = {shape_.pixels,
                                  light_class,
                                  options.shadows ? shape_.maps : shared::maps_none,
                                  filters_maps(options.filter, light_class),
                                  options.count_clamped,
                                  shape_.storage_lights,
                                  map_bits};
    description.name = "brute force";
    return pipelines_.compute(description);
}

Status BruteForce::add_pass(const BruteForceFrame& frame, std::span<const LightBatch> batches,
                            const BruteForceOptions& options, bool first, bool last) {
    for (std::size_t i = 0; i < batches.size(); ++i) {
        SUNFLECK_ASSIGN(const gpu::Pipeline* kernel, pipeline(batches[i].light_class, options, frame.maps.bits()));
        shared::BruteForceConstants constants{};
        constants.width = frame.g_buffer.width;
        constants.height = frame.g_buffer.height;
        constants.light_count = batches[i].count;
        constants.map_resolution = frame.maps.resolution();
        constants.first_batch = first && i == 0;
        constants.last_batch = last && i + 1 == batches.size();
        constants.group_columns = group_columns(frame.g_buffer.width, shape_.pixels);
        add_bands(frame, *kernel, batches[i], constants);
    }
    if (options.count_clamped && last)
        readback_.add_pass(frame.graph, *clamped_sums_, serial_);
    return {};
}

void BruteForce::add_bands(const BruteForceFrame& frame, const gpu::Pipeline& kernel, const LightBatch& batch,
                           shared::BruteForceConstants constants) {
    const gpu::Buffer& texels = frame.maps.texels() ? frame.maps.texels() : unused_texels_;
    const bool accumulates = constants.first_batch == 0 || constants.last_batch == 0;
    const std::uint32_t rows_at_once = accumulates ? band_rows(constants.width) : constants.height;
    const VkDeviceSize row_bytes = VkDeviceSize(constants.width) * sizeof(vec4);
    for (constants.first_row = 0; constants.first_row < constants.height; constants.first_row += rows_at_once) {
        const std::uint32_t rows = std::min(rows_at_once, constants.height - constants.first_row);
        const VkDeviceSize first_sum = accumulates ? row_bytes * constants.first_row : 0;
        gpu::ComputePass(frame.graph, "brute force", kernel)
            .uniform(frame.camera)
            .sampled(frame.g_buffer.depth, sampler_)
            .sampled(frame.g_buffer.normals, sampler_)
            .uniform(batch.rows)
            .storage_read(batch.rows)
            .texels(texels)
            .storage_read({texels, 0, std::min(texels.size(), device_.traits().max_storage_range)})
            .storage_read_write({accumulation_, first_sum, accumulates ? row_bytes * rows : 16})
            .storage_write(frame.output)
            .storage_read_write(clamped_sums_->buffer)
            .push(constants)
            .dispatch(constants.group_columns, group_rows(rows));
    }
}

} // namespace sunfleck::gi

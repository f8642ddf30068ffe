#include "gi_module/brute_force/brute_force.h"

#include <algorithm>

namespace sunfleck::gi {
namespace {

std::uint32_t group_columns(std::uint32_t width, std::uint32_t pixels) {
    const std::uint32_t tile = shared::kernel_lanes * pixels;
    return (width + tile - 1) / tile;
}

std::uint32_t group_rows(std::uint32_t height) {
    return (height + shared::kernel_rows - 1) / shared::kernel_rows;
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
    unused.texel_format = VK_FORMAT_R32_SFLOAT;
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

Status BruteForce::begin_frame(std::uint32_t width, std::uint32_t height, bool accumulates, std::uint64_t serial,
                               std::uint64_t completed_serial, gpu::FrameResources& resources) {
    serial_ = serial;
    for (const Readback& readback : readbacks_) {
        if (readback.serial == 0 || readback.serial > completed_serial || readback.serial <= clamped_.serial)
            continue;
        double flux = 0, irradiance = 0, pixels = 0;
        const auto* sums = reinterpret_cast<const vec4*>(readback.sums.mapped());
        for (std::uint32_t i = 0; i < readback.groups; ++i) {
            flux += double(sums[i].x);
            irradiance += double(sums[i].y);
            pixels += double(sums[i].z);
        }
        clamped_ = {flux, pixels > 0 ? irradiance / pixels : 0.0, readback.serial};
    }
    const VkDeviceSize bytes = accumulates ? VkDeviceSize(width) * height * sizeof(vec4) : 16;
    if (!accumulation_ || accumulation_.size() < bytes) {
        if (accumulation_)
            resources.retire(std::move(accumulation_));
        SUNFLECK_ASSIGN(accumulation_,
                        gpu::Buffer::create(device_, {"irradiance sums", bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                                                      gpu::MemoryUse::device, VK_FORMAT_UNDEFINED}));
    }
    const std::uint32_t groups = group_columns(width, shape_.pixels) * group_rows(height);
    const auto ready = std::find_if(readbacks_.begin(), readbacks_.end(), [&](const Readback& readback) {
        return readback.serial <= completed_serial && readback.sums.size() >= groups * sizeof(vec4);
    });
    current_readback_ = std::size_t(ready - readbacks_.begin());
    if (ready == readbacks_.end()) {
        Readback fresh;
        SUNFLECK_ASSIGN(fresh.sums, gpu::Buffer::create(device_, {"clamped flux sums", groups * sizeof(vec4),
                                                                  VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                                                                  gpu::MemoryUse::readback, VK_FORMAT_UNDEFINED}));
        readbacks_.push_back(std::move(fresh));
    }
    readbacks_[current_readback_].serial = 0;
    readbacks_[current_readback_].groups = groups;
    return {};
}

Result<const gpu::Pipeline*> BruteForce::pipeline(std::uint32_t light_class, const BruteForceOptions& options,
                                                  std::uint32_t map_bits) {
    const std::vector<std::uint32_t> specialization = {shape_.pixels,
                                                       light_class,
                                                       options.shadows ? shape_.maps : shared::maps_none,
                                                       filters_maps(options.filter, light_class),
                                                       options.count_clamped,
                                                       shape_.storage_lights,
                                                       map_bits};
    if (const auto found = kernels_.find(specialization); found != kernels_.end())
        return found->second;
    using enum gpu::BindingKind;
    gpu::ComputeDescription description;
    description.shader = "gi_module/brute_force/brute_force.comp";
    description.bindings = {uniform_buffer, sampled_image,  sampled_image,  uniform_buffer, storage_buffer,
                            texel_buffer,   storage_buffer, storage_buffer, storage_image,  storage_buffer};
    description.push_constant_bytes = sizeof(shared::BruteForceConstants);
    description.specialization = specialization;
    description.name = "brute force";
    SUNFLECK_ASSIGN(const gpu::Pipeline* made, pipelines_.compute(description));
    kernels_[specialization] = made;
    return made;
}

Status BruteForce::add_pass(gpu::FrameGraph& graph, const GBufferInput& g_buffer, const gpu::UploadSlice& camera,
                            const ShadowMaps& maps, std::span<const LightBatch> batches,
                            const BruteForceOptions& options, bool first, bool last, gpu::ResourceId output) {
    Readback& readback = readbacks_[current_readback_];
    if (options.count_clamped && last)
        readback.serial = serial_;
    const gpu::ResourceId accumulation = graph.import_buffer(accumulation_);
    const gpu::ResourceId sums = graph.import_buffer(readback.sums);
    for (std::size_t i = 0; i < batches.size(); ++i) {
        const LightBatch& batch = batches[i];
        SUNFLECK_ASSIGN(const gpu::Pipeline* kernel, pipeline(batch.light_class, options, maps.bits()));
        shared::BruteForceConstants constants{};
        constants.width = g_buffer.width;
        constants.height = g_buffer.height;
        constants.light_count = batch.count;
        constants.map_resolution = maps.resolution();
        constants.first_batch = first && i == 0;
        constants.last_batch = last && i + 1 == batches.size();
        constants.group_columns = group_columns(g_buffer.width, shape_.pixels);
        auto pass = graph.add_pass("brute force");
        pass.read(g_buffer.depth, gpu::Usage::sampled).read(g_buffer.normals, gpu::Usage::sampled);
        if (maps.texels())
            pass.read(graph.import_buffer(maps.texels()), gpu::Usage::texel_read)
                .read(graph.import_buffer(maps.texels()), gpu::Usage::storage_read);
        pass.write(accumulation, gpu::Usage::storage_read_write)
            .write(sums, gpu::Usage::storage_read_write)
            .write(output, gpu::Usage::storage_write)
            .execute([this, kernel, camera, batch, constants, g_buffer, output, &maps,
                      &readback_sums = readback.sums](gpu::PassContext& context) {
                return dispatch(context, *kernel, camera, batch, constants, g_buffer, output, maps, readback_sums);
            });
    }
    if (options.count_clamped && last)
        graph.add_pass("clamped flux").read(sums, gpu::Usage::host_read).keep();
    return {};
}

Status BruteForce::dispatch(gpu::PassContext& context, const gpu::Pipeline& kernel, const gpu::UploadSlice& camera,
                            const LightBatch& batch, shared::BruteForceConstants constants,
                            const GBufferInput& g_buffer, gpu::ResourceId output, const ShadowMaps& maps,
                            const gpu::Buffer& clamped_sums) const {
    const gpu::Buffer& texels = maps.texels() ? maps.texels() : unused_texels_;
    const bool accumulates = constants.first_batch == 0 || constants.last_batch == 0;
    const std::uint32_t rows_at_once = accumulates ? band_rows(constants.width) : constants.height;
    for (constants.first_row = 0; constants.first_row < constants.height; constants.first_row += rows_at_once) {
        const std::uint32_t rows = std::min(rows_at_once, constants.height - constants.first_row);
        const VkDeviceSize row_bytes = VkDeviceSize(constants.width) * sizeof(vec4);
        const gpu::Binding bindings[] = {
            gpu::Binding::slice(camera),
            gpu::Binding::sampled_image(context.graph.view(g_buffer.depth), sampler_),
            gpu::Binding::sampled_image(context.graph.view(g_buffer.normals), sampler_),
            gpu::Binding::slice(batch.rows),
            gpu::Binding::slice(batch.rows),
            gpu::Binding::texels(texels),
            gpu::Binding::range(texels, 0, std::min(texels.size(), device_.traits().max_storage_range)),
            accumulates ? gpu::Binding::range(accumulation_, row_bytes * constants.first_row, row_bytes * rows)
                        : gpu::Binding::range(accumulation_, 0, 16),
            gpu::Binding::storage_image(context.graph.view(output)),
            gpu::Binding::buffer(clamped_sums)};
        SUNFLECK_TRY(context.resources.bind(context.commands, kernel, bindings));
        context.resources.push(context.commands, kernel, constants);
        context.device.vk.vkCmdDispatch(context.commands, constants.group_columns, group_rows(rows), 1);
    }
    return {};
}

} // namespace sunfleck::gi

#include "engine/render/exposure_meter.h"

#include "engine/core/divide_up.h"
#include "engine/gpu/compute_pass.h"

namespace sunfleck::render {

Result<std::unique_ptr<ExposureMeter>> ExposureMeter::create(gpu::Device& device, gpu::PipelineStore& pipelines) {
    std::unique_ptr<ExposureMeter> meter(new ExposureMeter(device));
    gpu::ComputeDescription description;
    description.shader = "engine/render/exposure_meter.comp";
    for (const std::uint32_t emission : {0, 1})
        for (const std::uint32_t sky : {0, 1}) {
            description.specialization = {emission, sky};
            SUNFLECK_ASSIGN(meter->kernels_[emission][sky], pipelines.compute(description));
        }
    const VkSamplerCreateInfo sampler{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
    SUNFLECK_VK(device.vk.vkCreateSampler(device.handle(), &sampler, nullptr, &meter->sampler_), "creating a sampler");
    return meter;
}

ExposureMeter::~ExposureMeter() {
    device_.vk.vkDestroySampler(device_.handle(), sampler_, nullptr);
}

Status ExposureMeter::add(gpu::FrameGraph& graph, const scene::GpuScene& scene, const GBuffer& g_buffer,
                          const CompositionInput& input, const gpu::UploadSlice& camera, Frame frame) {
    constexpr std::uint64_t bytes = sizeof(float) * shared::meter_columns * shared::meter_rows;
    SUNFLECK_ASSIGN(gpu::ReadbackRing::Slot * slot, points_.acquire(frame.completed, bytes));
    const bool emission = g_buffer.emission.valid(), sky = input.sky_image != nullptr && *input.sky_image;
    gpu::ComputePass pass(graph, "exposure meter", *kernels_[emission][sky]);
    // What there is not must be bound all the same; the albedo stands in for it, unread.
    pass.sampled(input.irradiance, sampler_)
        .sampled(g_buffer.albedo, sampler_)
        .sampled(g_buffer.surface, sampler_)
        .sampled(emission ? g_buffer.emission : g_buffer.albedo, sampler_);
    if (input.sky_image != nullptr)
        pass.constant(input.sky_image->binding());
    else
        pass.sampled(g_buffer.albedo, sampler_);
    pass.uniform(camera)
        .storage_read(scene.rows())
        .storage_write({slot->buffer, 0, bytes})
        .push(composition_constants(g_buffer, input))
        .dispatch(divide_up(shared::meter_columns, 8), divide_up(shared::meter_rows, 8));
    points_.add_pass(graph, *slot, frame.serial);
    return {};
}

std::span<const float> ExposureMeter::collect(std::uint64_t completed) {
    const gpu::ReadbackRing::Slot* const slot = points_.collect(completed);
    return slot != nullptr ? gpu::ReadbackRing::content<float>(*slot) : std::span<const float>();
}

} // namespace sunfleck::render

#include "engine/render/temporal_enlargement.h"

#include "engine/core/divide_up.h"
#include "engine/core/maths.h"
#include "engine/gpu/compute_pass.h"
#include "engine/render/enlargement.h"

namespace sunfleck::render {
namespace {

struct TemporalConstants {
    EnlargementSizes sizes;
    vec2 offset;
    std::uint32_t has_history;
};

struct StillConstants {
    EnlargementSizes sizes;
    vec2 offset;
    std::uint32_t first;
};

} // namespace

Result<std::unique_ptr<TemporalEnlargement>> TemporalEnlargement::create(gpu::Device& device,
                                                                         gpu::PipelineStore& pipelines) {
    std::unique_ptr<TemporalEnlargement> result(new TemporalEnlargement(device));
    const VkSamplerCreateInfo sampler{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO}; // for texelFetch
    SUNFLECK_VK(device.vk.vkCreateSampler(device.handle(), &sampler, nullptr, &result->sampler_), "creating a sampler");
    gpu::ComputeDescription description;
    description.shader = "engine/render/temporal_enlargement.comp";
    description.specialization = {0};
    SUNFLECK_ASSIGN(result->any_, pipelines.compute(description));
    description.specialization = {1};
    SUNFLECK_ASSIGN(result->doubling_, pipelines.compute(description));
    description.shader = "engine/render/still_picture.comp";
    description.specialization = {0};
    SUNFLECK_ASSIGN(result->sum_, pipelines.compute(description));
    description.specialization = {1};
    SUNFLECK_ASSIGN(result->show_, pipelines.compute(description));
    return result;
}

TemporalEnlargement::~TemporalEnlargement() {
    device_.vk.vkDestroySampler(device_.handle(), sampler_, nullptr);
}

// Four frames sample the four quarters of a pixel, which are the pixels of a picture of twice the size; four such turns
// sample each of those at four places, of which no two share a row or column.
vec2 TemporalEnlargement::offset() const {
    constexpr vec2 quarters[] = {{-0.25f, -0.25f}, {0.25f, 0.25f}, {0.25f, -0.25f}, {-0.25f, 0.25f}};
    constexpr vec2 places[] = {{-0.125f, -0.375f}, {0.125f, 0.375f}, {0.375f, -0.125f}, {-0.375f, 0.125f}};
    static_assert(round_length == std::size(quarters) * std::size(places));
    return quarters[frame_ % 4] + 0.5f * places[frame_ / 4 % 4];
}

void TemporalEnlargement::apply_offset(shared::CameraRow& camera, vec2 offset) {
    // A point at `offset` from a pixel's middle comes to lie in that middle.
    const vec2 move = -2.0f * offset / vec2(camera.forward.w, camera.right.w);
    for (mat4* matrix : {&camera.view_projection, &camera.previous_view_projection})
        for (int column = 0; column < 4; ++column) {
            (*matrix)[column].x += move.x * (*matrix)[column].w;
            (*matrix)[column].y += move.y * (*matrix)[column].w;
        }
    const vec3 forward = vec3(camera.forward) - vec3(camera.right) * move.x - vec3(camera.down) * move.y;
    camera.forward = vec4(forward, camera.forward.w);
}

Status TemporalEnlargement::make_images(const gpu::ImageDescription& target, gpu::FrameResources& resources) {
    for (gpu::Image* image : {&histories_[0], &histories_[1], &sums_}) {
        if (*image && image->description().width == target.width && image->description().height == target.height)
            continue;
        if (*image)
            resources.retire(std::move(*image));
        gpu::ImageDescription description;
        description.name = image == &sums_ ? "still picture" : "picture history";
        description.format = image == &sums_ ? VK_FORMAT_R32G32B32A32_SFLOAT : VK_FORMAT_R32_UINT;
        description.width = target.width;
        description.height = target.height;
        description.usage = VK_IMAGE_USAGE_STORAGE_BIT;
        SUNFLECK_ASSIGN(*image, gpu::Image::create(device_, description));
        forget();
    }
    return {};
}

void TemporalEnlargement::forget() {
    has_history_ = false;
    frame_ = summed_ = 0;
}

Status TemporalEnlargement::add(gpu::FrameGraph& graph, const Input& input, gpu::ResourceId target,
                                gpu::FrameResources& resources) {
    SUNFLECK_TRY(make_images(graph.description(target), resources));
    if (input.changes)
        summed_ = 0;
    if (summed_ == round_length) {
        add_still(graph, *show_, input, target);
        return {};
    }
    // From the beginning of a round on, so that the same picture comes to rest as the same.
    if (!input.changes && (summed_ > 0 || frame_ % round_length == 0)) {
        add_still(graph, *sum_, input, target);
        ++summed_;
    }
    add_moving(graph, input, target);
    ++frame_;
    has_history_ = true;
    return {};
}

void TemporalEnlargement::add_still(gpu::FrameGraph& graph, const gpu::Pipeline& kernel, const Input& input,
                                    gpu::ResourceId target) const {
    const EnlargementSizes sizes(graph.description(input.picture), graph.description(target));
    const glm::uvec2 invocations(sizes.target);
    gpu::ComputePass(graph, "still picture", kernel)
        .storage_read(input.picture)
        .storage_read_write(graph.import_image(sums_))
        .storage_write(target)
        .push(StillConstants{sizes, offset(), summed_ == 0})
        .dispatch(divide_up(invocations.x, 8), divide_up(invocations.y, 8));
}

void TemporalEnlargement::add_moving(gpu::FrameGraph& graph, const Input& input, gpu::ResourceId target) const {
    const EnlargementSizes sizes(graph.description(input.picture), graph.description(target));
    const glm::uvec2 invocations(sizes.doubles() ? sizes.source : sizes.target);
    gpu::ComputePass(graph, "temporal enlargement", sizes.doubles() ? *doubling_ : *any_)
        .storage_read(input.picture)
        .sampled(input.depth, sampler_)
        .sampled(input.motion, sampler_)
        .storage_read(graph.import_image(histories_[(frame_ + 1) % 2]))
        .storage_write(graph.import_image(histories_[frame_ % 2]))
        .storage_read_write(target)
        .push(TemporalConstants{sizes, offset(), has_history_})
        .dispatch(divide_up(invocations.x, 8), divide_up(invocations.y, 8));
}

} // namespace sunfleck::render

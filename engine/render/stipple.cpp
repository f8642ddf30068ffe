#include "engine/render/stipple.h"

#include "engine/core/divide_up.h"
#include "engine/gpu/compute_pass.h"

#include <algorithm>

namespace sunfleck::render {
namespace {

// Pixels about a stippled one that its square reaches (stipple.comp), and one for the corners' rounding.
constexpr float reach = 3.0f;

// Edges of a rectangle in pixels; without any if low > high.
struct PixelBounds {
    vec2 low{1e30f}, high{-1e30f};
};

// Adds what of the box may show. False if the box passes the camera: then it may be anywhere.
bool add_box(const Bounds& box, const shared::CameraRow& camera, PixelBounds& bounds) {
    PixelBounds shown;
    int behind = 0;
    for (int i = 0; i < 8; ++i) {
        const vec3 corner((i & 1) != 0 ? box.maximum.x : box.minimum.x, (i & 2) != 0 ? box.maximum.y : box.minimum.y,
                          (i & 4) != 0 ? box.maximum.z : box.minimum.z);
        const vec4 clip = camera.view_projection * vec4(corner, 1.0f);
        if (clip.w <= camera.position.w) {
            ++behind;
            continue;
        }
        const vec2 pixel = (vec2(clip) / clip.w * 0.5f + 0.5f) * vec2(camera.forward.w, camera.right.w);
        shown.low = glm::min(shown.low, pixel);
        shown.high = glm::max(shown.high, pixel);
    }
    if (behind == 0) {
        bounds.low = glm::min(bounds.low, shown.low);
        bounds.high = glm::max(bounds.high, shown.high);
    }
    return behind == 0 || behind == 8;
}

} // namespace

PixelRectangle stippled_rectangle(const scene::GpuScene& scene, const shared::CameraRow& camera) {
    const vec2 size(camera.forward.w, camera.right.w);
    PixelBounds bounds;
    for (const scene::DrawItem& item : scene.draws())
        if ((item.constants.surface & shared::surface_stippled) != 0 && !add_box(item.bounds, camera, bounds))
            return {0, 0, std::uint32_t(size.x), std::uint32_t(size.y)};
    const vec2 low = glm::clamp(glm::floor(bounds.low - reach), vec2(0.0f), size);
    const vec2 high = glm::clamp(glm::ceil(bounds.high + reach), vec2(0.0f), size);
    if (low.x >= high.x || low.y >= high.y)
        return {};
    return {std::int32_t(low.x), std::int32_t(low.y), std::uint32_t(high.x - low.x), std::uint32_t(high.y - low.y)};
}

Result<StipplePass> StipplePass::create(gpu::Device& device, gpu::PipelineStore& pipelines) {
    StipplePass pass;
    gpu::ComputeDescription description;
    description.shader = "engine/render/stipple.comp";
    SUNFLECK_ASSIGN(pass.kernel_, pipelines.compute(description));
    const VkSamplerCreateInfo sampler{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
    SUNFLECK_VK(device.vk.vkCreateSampler(device.handle(), &sampler, nullptr, &pass.sampler_), "creating a sampler");
    return pass;
}

void StipplePass::destroy(gpu::Device& device) {
    device.vk.vkDestroySampler(device.handle(), sampler_, nullptr);
    sampler_ = VK_NULL_HANDLE;
}

void StipplePass::add(gpu::FrameGraph& graph, const GBuffer& g_buffer, const PixelRectangle& rectangle,
                      gpu::ResourceId picture, VkFormat format) const {
    if (rectangle.width == 0)
        return;
    // As large as the picture, so that a rectangle of another size needs no other image.
    const gpu::ResourceId blended = graph.create_image("blended surfaces", format, g_buffer.width, g_buffer.height);
    gpu::ComputePass(graph, "stippled surfaces", *kernel_)
        .sampled(picture, sampler_)
        .sampled(g_buffer.surface, sampler_)
        .sampled(g_buffer.depth, sampler_)
        .storage_write(blended)
        .push(rectangle)
        .dispatch(divide_up(rectangle.width, 8), divide_up(rectangle.height, 8));
    graph.add_pass("stippled surfaces copy")
        .read(blended, gpu::Usage::blit_source)
        .write(picture, gpu::Usage::blit_destination)
        .execute([=](gpu::PassContext& context) -> Status {
            const auto right = std::int32_t(rectangle.width), below = std::int32_t(rectangle.height);
            VkImageBlit region{};
            region.srcSubresource = region.dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
            region.srcOffsets[1] = {right, below, 1};
            region.dstOffsets[0] = {rectangle.x, rectangle.y, 0};
            region.dstOffsets[1] = {rectangle.x + right, rectangle.y + below, 1};
            context.device.vk.vkCmdBlitImage(context.commands, context.graph.image(blended),
                                             VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, context.graph.image(picture),
                                             VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region, VK_FILTER_NEAREST);
            return {};
        });
}

} // namespace sunfleck::render

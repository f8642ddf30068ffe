#include "gi_module/light_sum/pixel_area.h"

#include "engine/scene/camera_shared.h"

#include <cstring>

namespace sunfleck::gi {

PixelArea covered_pixels(std::span<const Bounds> boxes, const gpu::UploadSlice& camera, std::uint32_t width,
                         std::uint32_t height) {
    shared::CameraRow row;
    std::memcpy(&row, camera.data, sizeof row);
    vec2 low(1e9f), high(-1e9f);
    for (const Bounds& b : boxes)
        for (int i = 0; i < 8; ++i) {
            const vec3 corner(i & 1 ? b.maximum.x : b.minimum.x, i & 2 ? b.maximum.y : b.minimum.y,
                              i & 4 ? b.maximum.z : b.minimum.z);
            const vec4 clip = row.view_projection * vec4(corner, 1.0f);
            if (clip.w <= 1e-4f)
                return {0, 0, width, height};
            const vec2 place(clip.x / clip.w, clip.y / clip.w);
            low = glm::min(low, place);
            high = glm::max(high, place);
        }
    if (boxes.empty())
        return {};
    const vec2 size{float(width), float(height)};
    const vec2 first = glm::clamp(glm::floor((low * 0.5f + 0.5f) * size) - 1.0f, vec2(0.0f), size);
    const vec2 end = glm::clamp(glm::ceil((high * 0.5f + 0.5f) * size) + 1.0f, first, size);
    return {std::uint32_t(first.x), std::uint32_t(first.y), std::uint32_t(end.x - first.x),
            std::uint32_t(end.y - first.y)};
}

} // namespace sunfleck::gi

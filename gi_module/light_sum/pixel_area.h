// A rectangle of a picture.
#pragma once

#include "engine/core/maths.h"
#include "engine/gpu/frame_resources.h"

#include <span>

namespace sunfleck::gi {

struct PixelArea {
    std::uint32_t x = 0, y = 0, width = 0, height = 0;
};

// The pixels that any of the boxes may cover; the whole picture if one reaches behind the camera. `camera`: a CameraRow
// in the boxes' space.
PixelArea covered_pixels(std::span<const Bounds> boxes, const gpu::UploadSlice& camera, std::uint32_t width,
                         std::uint32_t height);

} // namespace sunfleck::gi

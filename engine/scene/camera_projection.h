// A camera from matrices of any perspective projection: forward or reverse Z, finite or infinite far plane, off-centre,
// jittered. Lighting works on one form of depth, reverse Z without a far plane (camera_shared.h); DepthMapping leads
// there from the depth that a matrix writes.
#pragma once

#include "engine/core/result.h"
#include "engine/scene/camera_shared.h"

#include <cstdint>

namespace sunfleck::scene {

// near / distance = (depth - background + offset + slope . ndc) * scale, with the camera row's near distance.
struct DepthMapping {
    float background = 0.0f; // depth where nothing is: 0 with reverse Z, 1 with forward Z
    float offset = 0.0f;
    float scale = 1.0f;
    vec2 slope{0.0f}; // not zero only where the near plane is oblique

    // The depth already is near / distance.
    bool is_identity() const { return background == 0.0f && offset == 0.0f && scale == 1.0f && slope == vec2(0.0f); }
    // 0 where nothing is.
    float map(float depth, vec2 ndc) const {
        const float value = (depth - background + offset + glm::dot(slope, ndc)) * scale;
        return depth == background ? 0.0f : glm::max(value, 0.0f);
    }
};

struct ProjectedCamera {
    shared::CameraRow row; // previous_view_projection is that of the same frame
    DepthMapping depth;
};

// `world_to_clip` as in Vulkan: visible is |x|, |y| <= w with y down the picture, 0 <= z <= w. Refuses numbers that are
// not finite, singular matrices and orthographic projections.
Result<ProjectedCamera> camera_from_matrix(const glm::dmat4& world_to_clip, std::uint32_t width, std::uint32_t height);

} // namespace sunfleck::scene

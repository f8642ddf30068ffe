// A view, from a camera entity or explicit numbers, as renderers need it.
#pragma once

#include "engine/scene/camera_shared.h"
#include "engine/scene/components.h"

namespace sunfleck::scene {

struct CameraView {
    vec3 position{0.0f};
    vec3 target{0.0f, 0.0f, -1.0f};
    vec3 up{0.0f, 1.0f, 0.0f};
    float vertical_field_of_view = 0.9f; // rad

    // The same view, orbited about the target around the world's Y axis.
    CameraView orbited(float radians) const {
        CameraView result = *this;
        const quat turn = glm::angleAxis(radians, vec3(0.0f, 1.0f, 0.0f));
        result.position = target + turn * (position - target);
        result.up = turn * up;
        return result;
    }
};

inline constexpr float camera_near = 0.01f; // m, or units of the space that the camera is in

inline shared::CameraRow make_camera_row(const CameraView& view, std::uint32_t width, std::uint32_t height,
                                         float near_distance = camera_near) {
    const vec3 forward = glm::normalize(view.target - view.position);
    vec3 side = glm::cross(forward, view.up);
    if (glm::length(side) < 1e-6f) // looking along `up`
        side = glm::cross(forward, vec3(0.0f, 0.0f, std::abs(forward.z) < 0.9f ? 1.0f : 0.0f) +
                                       vec3(std::abs(forward.z) < 0.9f ? 0.0f : 1.0f, 0.0f, 0.0f));
    side = glm::normalize(side);
    const vec3 up = glm::cross(side, forward);
    const float half_height = std::tan(0.5f * view.vertical_field_of_view);
    const float half_width = half_height * float(width) / float(height);
    mat4 to_view(1.0f); // x right, y down, z forward
    for (int i = 0; i < 3; ++i) {
        to_view[i][0] = side[i];
        to_view[i][1] = -up[i];
        to_view[i][2] = forward[i];
    }
    to_view[3] =
        vec4(-glm::dot(side, view.position), glm::dot(up, view.position), -glm::dot(forward, view.position), 1.0f);
    mat4 projection(0.0f);
    projection[0][0] = 1.0f / half_width;
    projection[1][1] = 1.0f / half_height;
    projection[2][3] = 1.0f;
    projection[3][2] = near_distance;
    shared::CameraRow row;
    row.view_projection = projection * to_view;
    row.previous_view_projection = row.view_projection;
    row.position = vec4(view.position, near_distance);
    row.forward = vec4(forward, float(width));
    row.right = vec4(side * half_width, float(height));
    row.down = vec4(-up * half_height, 0.0f);
    row.axis = vec4(forward, 0.0f);
    return row;
}

// A camera entity's view; the target lies `distance` ahead.
inline CameraView camera_view(const ecs::Registry& registry, ecs::Entity entity, float distance = 3.0f) {
    const mat4 matrix = world_matrix(registry, entity);
    CameraView view;
    view.position = vec3(matrix[3]);
    view.target = view.position - distance * glm::normalize(vec3(matrix[2]));
    view.up = glm::normalize(vec3(matrix[1]));
    if (const Camera* camera = registry.try_get<Camera>(entity))
        view.vertical_field_of_view = camera->vertical_field_of_view;
    return view;
}

} // namespace sunfleck::scene

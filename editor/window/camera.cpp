#include "editor/window/camera.h"

#include <algorithm>
#include <cmath>

namespace sunfleck::editor {
namespace {

constexpr float radians_per_pixel = 0.004f;
constexpr float steepest = 1.55f;   // rad, so that up stays up
constexpr float closest = 0.02f;    // to what it looks at, of the scene's size: nearer, the wheel moves that along
constexpr float farthest = 1000.0f; // by the wheel, of the scene's size
constexpr float per_notch = 0.88f;  // of the distance

} // namespace

void Camera::set(const scene::CameraView& view) {
    view_ = view;
}

vec3 Camera::forward() const {
    const vec3 offset = view_.target - view_.position;
    const float distance = glm::length(offset);
    return distance > 0.0f ? offset / distance : vec3(0.0f, 0.0f, -1.0f);
}

void Camera::turn(vec2 motion, bool about_target) {
    const float distance = std::max(glm::length(view_.target - view_.position), 1e-6f);
    const vec3 before = forward();
    float yaw = std::atan2(before.x, -before.z), pitch = std::asin(std::clamp(before.y, -1.0f, 1.0f));
    yaw += motion.x * radians_per_pixel;
    pitch = std::clamp(pitch - motion.y * radians_per_pixel, -steepest, steepest);
    const vec3 turned(std::sin(yaw) * std::cos(pitch), std::sin(pitch), -std::cos(yaw) * std::cos(pitch));
    view_.up = vec3(0.0f, 1.0f, 0.0f);
    if (about_target)
        view_.position = view_.target - distance * turned;
    else
        view_.target = view_.position + distance * turned;
}

void Camera::look(vec2 motion) {
    turn(motion, false);
}

void Camera::orbit(vec2 motion) {
    turn(motion, true);
}

void Camera::pan(vec2 motion, float height) {
    const shared::CameraRow row = scene::make_camera_row(view_, 1, 1);
    const float distance = glm::length(view_.target - view_.position);
    const float per_pixel = 2.0f * distance / std::max(height, 1.0f);
    const vec3 shift = -(vec3(row.right) * motion.x + vec3(row.down) * motion.y) * per_pixel;
    view_.position += shift;
    view_.target += shift;
}

void Camera::dolly(float notches, float scene_size) {
    const float distance = glm::length(view_.target - view_.position), least = closest * scene_size;
    const float back = distance - std::max(distance, farthest * scene_size); // the last step away
    const float step = std::max(std::max(distance, least) * (1.0f - std::pow(per_notch, notches)), back);
    const vec3 way = forward();
    view_.position += way * step;
    if (distance - step < least)
        view_.target = view_.position + way * least;
}

bool Camera::fly(const app::InputState& input, double seconds, float scene_size) {
    speed = std::clamp(speed * std::pow(1.2f, input.scroll), 0.01f, 100.0f);
    const auto axis = [&](app::Key more, app::Key less) { return float(input.down(more)) - float(input.down(less)); };
    const vec3 ahead = forward(), across = glm::cross(ahead, view_.up);
    const float width = glm::length(across); // none where it looks along `up`
    const vec3 side = width > 1e-6f ? across / width : vec3(1.0f, 0.0f, 0.0f);
    const vec3 way = ahead * axis('W', 'S') + side * axis('D', 'A') + vec3(0.0f, 1.0f, 0.0f) * axis('E', 'Q');
    if (way == vec3(0.0f))
        return false;
    const float pace = 0.25f * scene_size * speed * (input.down(app::key_left_shift) ? 4.0f : 1.0f);
    const vec3 shift = way * (pace * float(std::min(seconds, 0.1)));
    view_.position += shift;
    view_.target += shift;
    return true;
}

void Camera::frame(const Bounds& bounds) {
    if (bounds.empty())
        return;
    const float radius = std::max(0.5f * glm::length(bounds.extent()), 1e-3f);
    const vec3 way = forward();
    view_.target = bounds.centre();
    view_.position = view_.target - way * (1.1f * radius / std::sin(0.5f * view_.vertical_field_of_view));
}

vec3 project(const scene::CameraView& view, vec2 size, vec3 position) {
    const shared::CameraRow row = scene::make_camera_row(view, std::uint32_t(size.x), std::uint32_t(size.y));
    const vec3 offset = position - view.position;
    const float distance = glm::dot(offset, vec3(row.axis));
    const vec3 right(row.right), down(row.down);
    const float along = std::abs(distance) < 1e-9f ? 1e-9f : distance;
    const vec2 place(glm::dot(offset, right) / glm::dot(right, right), glm::dot(offset, down) / glm::dot(down, down));
    return vec3((place / along * 0.5f + 0.5f) * size, distance);
}

vec3 ray_through(const scene::CameraView& view, vec2 size, vec2 pixel) {
    const shared::CameraRow row = scene::make_camera_row(view, std::uint32_t(size.x), std::uint32_t(size.y));
    return shared::camera_ray(row, pixel);
}

} // namespace sunfleck::editor

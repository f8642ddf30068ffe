// The viewport's camera: flown with keys and pointer, orbited about what is looked at.
#pragma once

#include "engine/app/window.h"
#include "engine/scene/camera_view.h"

namespace sunfleck::editor {

class Camera {
public:
    const scene::CameraView& view() const { return view_; }
    void set(const scene::CameraView& view);
    // Pixels of pointer movement.
    void look(vec2 motion);
    void orbit(vec2 motion);
    // Sideways; `height`: of the viewport, pixels.
    void pan(vec2 motion, float height);
    // Nearer by so many notches of the wheel. Close to what it looks at, it goes on past that.
    void dolly(float notches, float scene_size);
    // W A S D, Q and E down and up, shift faster. True if it moved.
    bool fly(const app::InputState& input, double seconds, float scene_size);
    // Looks at the whole of it from where it looks now.
    void frame(const Bounds& bounds);
    float speed = 1.0f; // of flying; the wheel changes it meanwhile

private:
    void turn(vec2 motion, bool about_target);
    // Where it looks; along -z where it stands on its target.
    vec3 forward() const;
    scene::CameraView view_;
};

// Where a point is in a viewport, pixels from its top left corner; z: distance along the axis, below 0 behind.
vec3 project(const scene::CameraView& view, vec2 size, vec3 position);
// From the camera through a pixel; not unit length, but 1 along the axis.
vec3 ray_through(const scene::CameraView& view, vec2 size, vec2 pixel);

} // namespace sunfleck::editor

// Handles in the viewport that move, rotate and scale what is selected, all of it about one pivot. A drag is one
// gesture; Escape takes it back.
#pragma once

#include "editor/window/session.h"

namespace sunfleck::editor {

class Gizmo {
public:
    // Draws the handles and follows the pointer. `hovered`: the pointer is over the picture. True if the pointer is the
    // gizmo's, over a handle or dragging one.
    bool draw(Session& session, bool hovered);
    bool dragging() const { return handle_ >= 0; }

private:
    struct Frame { // of the handles, in the world
        vec3 pivot{0.0f};
        mat3 axes{1.0f};
        float length = 1.0f; // of a handle, m
    };
    struct Pointer {
        vec3 origin{0.0f}, direction{0.0f};
    };
    Frame find_frame(Session& session);
    int handle_under(Session& session, const Frame& frame, vec2 pointer) const;
    void paint(Session& session, const Frame& frame, int hot) const;
    void begin(Session& session, const Frame& frame, int handle);
    void follow(Session& session);
    void end(Session& session, bool keep);
    mat4 change(Session& session, const Pointer& pointer);
    mat4 movement(Session& session, const Pointer& pointer) const;
    mat4 rotation(Session& session, const Pointer& pointer);
    vec3 scaling(Session& session, const Pointer& pointer) const;
    Pointer pointer_ray(Session& session, vec2 pixel) const;

    int handle_ = -1; // 0 to 2: an axis or ring, 3 to 5: the plane across an axis, 6: the middle
    GizmoMode mode_ = GizmoMode::move;
    Frame frame_;
    Pointer start_;
    vec2 start_pixel_{0.0f};
    float angle_ = 0.0f; // of a rotation, rad
    std::string said_;   // how far it went
    SeenState tops_state_;
    std::uint64_t locks_ = 0; // Session::lock_revision of these
    Entities tops_;           // of what is selected, but for what is locked
    vec3 pivot_{0.0f};        // their middle
    Entities entities_;
    std::vector<mat4> worlds_; // before
};

} // namespace sunfleck::editor

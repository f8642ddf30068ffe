#include "editor/window/gizmo.h"

#include "editor/window/overlay.h"
#include "editor/window/switches.h"
#include "editor/window/widgets.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace sunfleck::editor {
namespace {

constexpr float handle_pixels = 90.0f, reach_pixels = 8.0f, plane_share = 0.3f;
constexpr int middle = 6, ring_parts = 64;
constexpr ImU32 axis_colours[] = {IM_COL32(235, 90, 80, 255), IM_COL32(130, 205, 90, 255), IM_COL32(90, 150, 245, 255)};
constexpr ImU32 hot_colour = IM_COL32(255, 226, 120, 255), middle_colour = IM_COL32(235, 235, 235, 255);
const char* const axis_names[] = {"x", "y", "z", "plane x", "plane y", "plane z", "middle"};

float segment_distance(vec2 point, vec2 a, vec2 b) {
    const vec2 along = b - a;
    const float t = glm::clamp(glm::dot(point - a, along) / std::max(glm::dot(along, along), 1e-6f), 0.0f, 1.0f);
    return glm::length(point - a - along * t);
}

// Parameter of the point of a line that is nearest to a ray; unit directions.
float nearest_on_line(vec3 line, vec3 along, vec3 origin, vec3 direction) {
    const vec3 unit = glm::normalize(direction);
    const float parallel = glm::dot(along, unit), rest = 1.0f - parallel * parallel;
    const vec3 between = origin - line;
    return rest < 1e-6f ? 0.0f : (glm::dot(between, along) - parallel * glm::dot(between, unit)) / rest;
}

vec3 on_plane(vec3 point, vec3 normal, vec3 origin, vec3 direction) {
    const float slope = glm::dot(normal, direction);
    return std::abs(slope) < 1e-6f ? point : origin + direction * (glm::dot(normal, point - origin) / slope);
}

float snapped(float value, float step) {
    return std::round(value / step) * step;
}

vec3 ring_point(const mat3& axes, int axis, float angle) {
    return axes[(axis + 1) % 3] * std::cos(angle) + axes[(axis + 2) % 3] * std::sin(angle);
}

// Handles are where something is seen: at its origin, or where that is outside of it (geometry that was exported in
// world coordinates has it in a corner of the level) in its middle.
vec3 handles_of(const Placed& placed) {
    const Bounds& bounds = placed.bounds;
    const bool outside =
        glm::any(glm::lessThan(vec3(0.0f), bounds.minimum)) || glm::any(glm::greaterThan(vec3(0.0f), bounds.maximum));
    return vec3(placed.world * vec4(outside && !bounds.empty() ? bounds.centre() : vec3(0.0f), 1.0f));
}

vec3 middle_of(Document& document, const Entities& entities) {
    vec3 sum(0.0f);
    float count = 0.0f;
    for (const Entity entity : entities)
        if (const auto placed = place_of(document, entity)) {
            sum += handles_of(*placed);
            count += 1.0f;
        }
    return sum / std::max(count, 1.0f);
}

bool snaps(const Session& session) {
    return session.gizmo.snap != ImGui::GetIO().KeyCtrl;
}

const char* verb(GizmoMode mode) {
    return mode == GizmoMode::move ? "Move " : mode == GizmoMode::rotate ? "Rotate " : "Scale ";
}

} // namespace

Gizmo::Pointer Gizmo::pointer_ray(Session& session, vec2 pixel) const {
    return {session.camera.view().position, ray_through(session.camera.view(), viewport_size(session), pixel)};
}

Gizmo::Frame Gizmo::find_frame(Session& session) {
    Frame frame;
    Document& document = *session.document;
    const bool other_locks = std::exchange(locks_, session.lock_revision) != session.lock_revision;
    if (tops_state_.follow(document) || other_locks) { // in other frames a large selection takes no longer
        tops_ = free_tops(session);
        pivot_ = middle_of(document, tops_);
    }
    frame.pivot = pivot_;
    if (!tops_.empty() && (session.gizmo.local || session.gizmo.mode == GizmoMode::scale)) {
        const mat4 world = world_of(document, tops_.back());
        for (int axis = 0; axis < 3; ++axis)
            if (const float length = glm::length(vec3(world[axis])); length > 1e-12f)
                frame.axes[axis] = vec3(world[axis]) / length;
    }
    const scene::CameraView& view = session.camera.view();
    const float distance = project(view, viewport_size(session), frame.pivot).z;
    const float pixel = 2.0f * std::tan(0.5f * view.vertical_field_of_view) / viewport_size(session).y;
    frame.length = distance * pixel * handle_pixels * ui::unit() / 14.0f;
    return frame;
}

int Gizmo::handle_under(Session& session, const Frame& frame, vec2 pointer) const {
    const auto at = [&](vec3 place) { return vec2(project(session.camera.view(), viewport_size(session), place)); };
    const vec2 centre = at(frame.pivot);
    if (session.gizmo.mode != GizmoMode::rotate && glm::length(pointer - centre) < reach_pixels)
        return middle;
    int nearest = -1;
    float best = reach_pixels;
    for (int axis = 0; axis < 3; ++axis) {
        float distance = 1e9f;
        if (session.gizmo.mode == GizmoMode::rotate)
            for (int i = 0; i < ring_parts; ++i)
                distance = std::min(
                    distance, segment_distance(
                                  pointer,
                                  at(frame.pivot +
                                     frame.length * ring_point(frame.axes, axis, float(i) * 2.0f * pi / ring_parts)),
                                  at(frame.pivot + frame.length * ring_point(frame.axes, axis,
                                                                             float(i + 1) * 2.0f * pi / ring_parts))));
        else
            distance = segment_distance(pointer, centre, at(frame.pivot + frame.length * frame.axes[axis]));
        if (distance < best) {
            best = distance;
            nearest = axis;
        }
        const vec3 corner = (frame.axes[(axis + 1) % 3] + frame.axes[(axis + 2) % 3]) * plane_share * frame.length;
        if (session.gizmo.mode == GizmoMode::move && nearest < 0 &&
            glm::length(pointer - at(frame.pivot + corner)) < 9.0f)
            nearest = axis + 3;
    }
    return nearest;
}

void Gizmo::paint(Session& session, const Frame& frame, int hot) const {
    ImDrawList* list = ImGui::GetWindowDrawList();
    const vec2 corner = viewport_corner(session);
    const auto at = [&](vec3 place) {
        const vec3 pixel = project(session.camera.view(), viewport_size(session), place);
        return ImVec2(corner.x + pixel.x, corner.y + pixel.y);
    };
    const auto mark = [&](int handle, ImVec2 place) {
        ui::note_place(std::string("gizmo ") + axis_names[handle], "", ImVec2(place.x - 4.0f, place.y - 4.0f),
                       ImVec2(place.x + 4.0f, place.y + 4.0f));
    };
    for (int axis = 0; axis < 3; ++axis) {
        const ImU32 colour = hot == axis ? hot_colour : axis_colours[axis];
        if (session.gizmo.mode == GizmoMode::rotate) {
            for (int i = 0; i < ring_parts; ++i)
                list->PathLineTo(
                    at(frame.pivot + frame.length * ring_point(frame.axes, axis, float(i) * 2.0f * pi / ring_parts)));
            list->PathStroke(colour, ImDrawFlags_Closed, hot == axis ? 3.5f : 2.0f);
            mark(axis, at(frame.pivot + frame.length * ring_point(frame.axes, axis, 0.8f)));
            continue;
        }
        const ImVec2 tip = at(frame.pivot + frame.length * frame.axes[axis]);
        list->AddLine(at(frame.pivot), tip, colour, hot == axis ? 4.0f : 2.5f);
        if (session.gizmo.mode == GizmoMode::scale)
            list->AddRectFilled(ImVec2(tip.x - 5.0f, tip.y - 5.0f), ImVec2(tip.x + 5.0f, tip.y + 5.0f), colour);
        else
            list->AddCircleFilled(tip, 6.0f, colour);
        mark(axis, tip);
        if (session.gizmo.mode != GizmoMode::move)
            continue;
        const ImVec2 plane =
            at(frame.pivot + (frame.axes[(axis + 1) % 3] + frame.axes[(axis + 2) % 3]) * plane_share * frame.length);
        list->AddRectFilled(ImVec2(plane.x - 5.0f, plane.y - 5.0f), ImVec2(plane.x + 5.0f, plane.y + 5.0f),
                            (hot == axis + 3 ? hot_colour : axis_colours[axis] & IM_COL32(255, 255, 255, 150)));
        mark(axis + 3, plane);
    }
    if (session.gizmo.mode != GizmoMode::rotate) {
        list->AddCircleFilled(at(frame.pivot), 5.0f, hot == middle ? hot_colour : middle_colour);
        mark(middle, at(frame.pivot));
    }
}

void Gizmo::begin(Session& session, const Frame& frame, int handle) {
    Document& document = *session.document;
    handle_ = handle;
    mode_ = session.gizmo.mode;
    frame_ = frame;
    start_pixel_ = pointer_in_viewport(session);
    start_ = pointer_ray(session, start_pixel_);
    angle_ = 0.0f;
    entities_ = tops_;
    worlds_.clear();
    for (const Entity entity : entities_)
        worlds_.push_back(world_of(document, entity));
    document.begin(verb(mode_) + what(document, entities_));
}

mat4 Gizmo::movement(Session& session, const Pointer& pointer) const {
    vec3 shift(0.0f);
    const float step = session.gizmo.steps.length;
    if (handle_ < 3) {
        const vec3 along = frame_.axes[handle_];
        float distance = nearest_on_line(frame_.pivot, along, pointer.origin, pointer.direction) -
                         nearest_on_line(frame_.pivot, along, start_.origin, start_.direction);
        if (snaps(session))
            distance = snapped(distance, step);
        shift = along * distance;
    } else {
        const vec3 normal = handle_ == middle
                                ? glm::normalize(session.camera.view().target - session.camera.view().position)
                                : frame_.axes[handle_ - 3];
        shift = on_plane(frame_.pivot, normal, pointer.origin, pointer.direction) -
                on_plane(frame_.pivot, normal, start_.origin, start_.direction);
        if (snaps(session)) {
            const vec3 along = glm::transpose(frame_.axes) * shift;
            shift = frame_.axes * vec3(snapped(along.x, step), snapped(along.y, step), snapped(along.z, step));
        }
    }
    return glm::translate(mat4(1.0f), shift);
}

mat4 Gizmo::rotation(Session& session, const Pointer& pointer) {
    const vec3 axis = frame_.axes[handle_];
    const vec3 from = on_plane(frame_.pivot, axis, start_.origin, start_.direction) - frame_.pivot;
    const vec3 to = on_plane(frame_.pivot, axis, pointer.origin, pointer.direction) - frame_.pivot;
    const bool edge_on = std::abs(glm::dot(glm::normalize(pointer.direction), axis)) < 0.12f;
    if (edge_on) { // the plane is a line on the screen
        const vec2 moved = pointer_in_viewport(session) - start_pixel_;
        angle_ = 0.01f * (moved.x - moved.y);
    } else {
        angle_ = std::atan2(glm::dot(axis, glm::cross(from, to)), glm::dot(from, to));
    }
    if (snaps(session))
        angle_ = snapped(angle_, glm::radians(session.gizmo.steps.angle));
    const mat4 turn = glm::mat4_cast(glm::angleAxis(angle_, axis));
    return glm::translate(mat4(1.0f), frame_.pivot) * turn * glm::translate(mat4(1.0f), -frame_.pivot);
}

vec3 Gizmo::scaling(Session& session, const Pointer& pointer) const {
    float factor = 1.0f;
    if (handle_ == middle) {
        const vec2 moved = pointer_in_viewport(session) - start_pixel_;
        factor = std::exp(0.008f * (moved.x - moved.y));
    } else {
        const vec3 along = frame_.axes[handle_];
        const float before = nearest_on_line(frame_.pivot, along, start_.origin, start_.direction);
        const float now = nearest_on_line(frame_.pivot, along, pointer.origin, pointer.direction);
        factor = std::abs(before) < 1e-12f ? 1.0f : std::max(now / before, 0.01f);
    }
    if (snaps(session))
        factor = std::max(snapped(factor, session.gizmo.steps.factor), session.gizmo.steps.factor);
    vec3 result(handle_ == middle ? factor : 1.0f);
    if (handle_ != middle)
        result[handle_] = factor;
    return result;
}

// From the worlds before to the worlds now; of a scaling, the part that moves what is beside the pivot.
mat4 Gizmo::change(Session& session, const Pointer& pointer) {
    char text[96];
    mat4 result(1.0f);
    if (mode_ == GizmoMode::move) {
        result = movement(session, pointer);
        std::snprintf(text, sizeof text, "%.3f  %.3f  %.3f m", double(result[3].x), double(result[3].y),
                      double(result[3].z));
    } else {
        result = rotation(session, pointer);
        std::snprintf(text, sizeof text, "%.1f\xc2\xb0", double(glm::degrees(angle_)));
    }
    said_ = text;
    return result;
}

void Gizmo::follow(Session& session) {
    Document& document = *session.document;
    const Pointer pointer = pointer_ray(session, pointer_in_viewport(session));
    if (mode_ != GizmoMode::scale) {
        const mat4 all = change(session, pointer);
        for (std::size_t i = 0; i < entities_.size(); ++i)
            set_world(document, entities_[i], all * worlds_[i]);
        return;
    }
    const vec3 factor = scaling(session, pointer);
    char text[96];
    std::snprintf(text, sizeof text, "%.3f  %.3f  %.3f", double(factor.x), double(factor.y), double(factor.z));
    said_ = text;
    for (std::size_t i = 0; i < entities_.size(); ++i) {
        mat4 world = worlds_[i] * glm::scale(mat4(1.0f), factor); // along its own axes
        const vec3 offset = glm::transpose(frame_.axes) * (vec3(worlds_[i][3]) - frame_.pivot);
        world[3] = vec4(frame_.pivot + frame_.axes * (offset * factor), 1.0f);
        set_world(document, entities_[i], world);
    }
}

void Gizmo::end(Session& session, bool keep) {
    handle_ = -1;
    said_.clear();
    if (keep)
        session.document->commit();
    else
        session.document->cancel();
}

bool Gizmo::draw(Session& session, bool hovered) {
    const bool has_handles = session.gizmo.mode != GizmoMode::none && session.gizmo.mode != GizmoMode::inspect;
    if (!has_handles || session.document->selection().empty()) {
        if (dragging())
            end(session, false);
        return false;
    }
    if (dragging()) {
        if (!session.document->in_gesture()) // ended by something else: undo, loss of focus
            handle_ = -1;
        else if (ImGui::IsKeyPressed(ImGui::GetIO().KeyMap[ImGuiKey_Escape], false))
            end(session, false);
        else
            follow(session); // also where it is let go: a slow frame has the last motion and the release
        if (dragging() && !ImGui::IsMouseDown(0))
            end(session, true);
    }
    const Frame frame = find_frame(session);
    if (tops_.empty() || frame.length <= 0.0f) // all locked; behind the camera
        return dragging();
    const int hot = dragging() ? handle_ : hovered ? handle_under(session, frame, pointer_in_viewport(session)) : -1;
    paint(session, frame, hot);
    if (!dragging() && hot >= 0 && ImGui::IsMouseClicked(0) && !ImGui::GetIO().KeyAlt)
        begin(session, frame, hot);
    if (dragging() && !said_.empty()) {
        const ImVec2 place = ImGui::GetIO().MousePos;
        const ImVec2 wide = ImGui::CalcTextSize(said_.c_str());
        ImDrawList* list = ImGui::GetWindowDrawList();
        list->AddRectFilled(ImVec2(place.x + 14.0f, place.y + 12.0f),
                            ImVec2(place.x + 22.0f + wide.x, place.y + 18.0f + wide.y), IM_COL32(20, 18, 16, 220),
                            3.0f);
        list->AddText(ImVec2(place.x + 18.0f, place.y + 15.0f), IM_COL32(255, 255, 255, 255), said_.c_str());
    }
    return hot >= 0;
}

} // namespace sunfleck::editor

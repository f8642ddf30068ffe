// The picture of the scene: flying, picking, and what is drawn over it.
#include "editor/panels/panel.h"

#include "editor/document/picking.h"
#include "editor/window/commands.h"
#include "editor/window/comparison_overlay.h"
#include "editor/window/field_parts.h"
#include "editor/window/overlay.h"
#include "editor/window/value_box.h"

#include <algorithm>
#include <cmath>

namespace sunfleck::editor {
namespace {

constexpr ImU32 selected_colour = IM_COL32(255, 176, 64, 255), other_colour = IM_COL32(235, 235, 235, 170);
constexpr double longest_step = 0.1; // s of flight in a frame
constexpr std::size_t most_outlines = 200, most_icons = 500;

// A line in the world, cut where it passes the camera.
void world_line(const Session& session, vec3 from, vec3 to, ImU32 colour, float width) {
    const scene::CameraView& view = session.camera.view();
    const vec2 size = viewport_size(session);
    const float near = scene::camera_near;
    const float a = project(view, size, from).z, b = project(view, size, to).z;
    if (a < near && b < near)
        return;
    if (a < near)
        from += (to - from) * ((near - a) / (b - a));
    if (b < near)
        to += (from - to) * ((near - b) / (a - b));
    const vec3 begin = project(view, size, from), end = project(view, size, to);
    const vec2 corner = viewport_corner(session);
    ImGui::GetWindowDrawList()->AddLine(ImVec2(corner.x + begin.x, corner.y + begin.y),
                                        ImVec2(corner.x + end.x, corner.y + end.y), colour, width);
}

void outline(const Session& session, const Placed& placed) {
    const auto corner = [&](int index) {
        const vec3 pick((index & 1) != 0 ? 1.0f : 0.0f, (index & 2) != 0 ? 1.0f : 0.0f, (index & 4) != 0 ? 1.0f : 0.0f);
        return vec3(placed.world * vec4(glm::mix(placed.bounds.minimum, placed.bounds.maximum, pick), 1.0f));
    };
    for (int index = 0; index < 8; ++index)
        for (const int axis : {1, 2, 4})
            if ((index & axis) == 0)
                world_line(session, corner(index), corner(index | axis), selected_colour, 1.5f);
}

void grid(Session& session) {
    const float step = session.grid_step();
    const int half = 20;
    for (int i = -half; i <= half; ++i) {
        const float place = float(i) * step, end = float(half) * step;
        const ImU32 colour = i == 0 ? IM_COL32(255, 255, 255, 90) : IM_COL32(255, 255, 255, 36);
        world_line(session, vec3(place, 0.0f, -end), vec3(place, 0.0f, end), colour, 1.0f);
        world_line(session, vec3(-end, 0.0f, place), vec3(end, 0.0f, place), colour, 1.0f);
    }
}

// Of what has no geometry: the colour of its light, if one of its components has any.
ImU32 icon_colour(Document& document, Entity entity) {
    for (const ecs::PoolBase* pool : document.registry().described_pools())
        if (pool->contains(entity))
            for (const Field& field : pool->description()->fields)
                if (is_colour(field) && !field.unit.empty()) {
                    const vec3 light = colour_of(field, pool->address(pool->position_of(entity.index)));
                    const vec3 shown = glm::sqrt(light / std::max({light.x, light.y, light.z, 1e-12f})) * 255.0f;
                    return IM_COL32(int(shown.x), int(shown.y), int(shown.z), 255);
                }
    return other_colour;
}

void icon(Session& session, Entity entity, vec3 place) {
    Document& document = *session.document;
    const vec2 corner = viewport_corner(session);
    const ImVec2 centre(corner.x + place.x, corner.y + place.y);
    const float radius = 0.42f * ui::unit();
    ImDrawList* list = ImGui::GetWindowDrawList();
    list->AddCircleFilled(centre, radius, IM_COL32(20, 18, 16, 180));
    list->AddCircleFilled(centre, 0.62f * radius, icon_colour(document, entity));
    list->AddCircle(centre, radius, document.selected(entity) ? selected_colour : other_colour, 0, 1.5f);
    ui::note_place("icon " + document.name(entity), document.selected(entity) ? "selected" : "",
                   ImVec2(centre.x - radius, centre.y - radius), ImVec2(centre.x + radius, centre.y + radius));
}

// A cross where a pixel was looked into.
void mark_inspected(const Session& session) {
    const auto pixel = session.scene.inspected();
    if (pixel == nullptr || pixel->report.entity.is_null())
        return;
    const vec3 place = project(session.camera.view(), viewport_size(session), pixel->report.position);
    if (place.z < scene::camera_near)
        return;
    const vec2 centre = viewport_corner(session) + vec2(place);
    const float arm = 0.6f * ui::unit();
    for (const float width : {3.5f, 1.5f})
        for (const vec2 along : {vec2(arm, 0.0f), vec2(0.0f, arm)})
            ImGui::GetWindowDrawList()->AddLine(
                ImVec2(centre.x - along.x, centre.y - along.y), ImVec2(centre.x + along.x, centre.y + along.y),
                width > 2.0f ? IM_COL32(20, 18, 16, 220) : IM_COL32(255, 255, 255, 255), width);
}

// Where there is nothing to be seen yet.
void say_how_to_begin(ImVec2 low, ImVec2 room) {
    const ui::Scope scope("begin");
    const char* const lines[] = {"Drop a glTF or scene file here,", "choose File, Open or a built-in scene,",
                                 "or make one from nothing: Add"};
    float y = low.y + 0.42f * room.y;
    for (const char* line : lines) {
        const ImVec2 size = ImGui::CalcTextSize(line);
        ImGui::SetCursorScreenPos(ImVec2(low.x + std::max(0.5f * (room.x - size.x), 0.0f), y));
        ui::text("line", line);
        y += 1.5f * size.y;
    }
}

// A line of text in the picture, on ground that it can be read on whatever is behind.
void line_in_picture(const char* name, const std::string& text, ImVec2 place, float width) {
    const ImVec2 size = ImGui::CalcTextSize(text.c_str(), nullptr, false, width);
    const float edge = 0.35f * ui::unit();
    ImGui::GetWindowDrawList()->AddRectFilled(ImVec2(place.x - edge, place.y - edge),
                                              ImVec2(place.x + size.x + edge, place.y + size.y + edge),
                                              IM_COL32(20, 18, 16, 200), edge);
    ImGui::SetCursorScreenPos(place);
    ImGui::PushTextWrapPos(place.x + width - ImGui::GetWindowPos().x);
    ImGui::TextWrapped("%s", text.c_str());
    ui::note(name, text);
    ImGui::PopTextWrapPos();
}

} // namespace

// What changes with edits, the selection and steps of a scene in motion alone, so that in other frames a large scene
// takes no longer.
void Viewport::find_places(Session& session) {
    Document& document = *session.document;
    const PlayedPlaces* const played = session.played.get();
    const bool others_moved = std::exchange(played_, session.played) != session.played;
    if (!places_state_.follow(document) && !others_moved)
        return;
    icon_places_.clear();
    for (const Entity entity : without_geometry(document))
        icon_places_.push_back({entity, vec3(world_of(document, entity, played)[3])});
    outlines_.clear();
    for (const Entity entity : document.selection()) {
        if (outlines_.size() == most_outlines)
            return;
        if (std::optional<Placed> placed = place_of(document, entity); placed && !placed->bounds.empty()) {
            placed->world = world_of(document, entity, played);
            outlines_.push_back(*placed);
        }
    }
}

// A picture may be black for no other reason, and a switch in the hierarchy is easily overlooked.
bool Viewport::no_lamp_shines(Session& session) {
    if (session.hidden.empty() && session.muted.empty())
        return false;
    Document& document = *session.document;
    if (lamps_state_.follow(document)) {
        lamps_.clear();
        for (const Entity root : document.roots())
            for (const Entity entity : document.family(root))
                if (emits(document, entity))
                    lamps_.push_back(entity);
    }
    return !lamps_.empty() && std::all_of(lamps_.begin(), lamps_.end(), [&](Entity lamp) {
        return session.hidden.count(lamp) > 0 || session.muted.count(lamp) > 0;
    });
}

std::vector<Viewport::Icon> Viewport::icons(Session& session) {
    find_places(session);
    std::vector<Icon> result;
    for (const auto& [entity, where] : icon_places_) {
        if (result.size() == most_icons)
            break;
        if (session.hidden.count(entity) > 0 || session.locked.count(entity) > 0)
            continue;
        const vec3 place = project(session.camera.view(), viewport_size(session), where);
        if (place.z > scene::camera_near && place.x > 0.0f && place.y > 0.0f && place.x < viewport_size(session).x &&
            place.y < viewport_size(session).y)
            result.push_back({entity, place});
    }
    return result;
}

Entity Viewport::icon_at(Session& session, vec2 place) {
    if (!session.view.show_icons)
        return ecs::null_entity;
    std::vector<Icon> there = icons(session);
    std::erase_if(there, [&](const Icon& one) { return glm::length(vec2(one.place) - place) >= 0.6f * ui::unit(); });
    std::stable_sort(there.begin(), there.end(), [](const Icon& a, const Icon& b) { return a.place.z < b.place.z; });
    if (there.empty())
        return ecs::null_entity;
    // Where they lie behind one another, the nearest; clicked again, the one behind what is selected.
    const std::vector<Entity>& selection = session.document->selection();
    const auto now = std::find_if(there.begin(), there.end(),
                                  [&](const Icon& one) { return selection.size() == 1 && selection[0] == one.entity; });
    return now == there.end() || now + 1 == there.end() ? there.front().entity : (now + 1)->entity;
}

void Viewport::click(Session& session) {
    Document& document = *session.document;
    const vec2 place = pointer_in_viewport(session);
    Entity entity = icon_at(session, place);
    if (entity.is_null())
        entity = pick(
                     document, session.camera.view().position,
                     ray_through(session.camera.view(), viewport_size(session), place),
                     [&](Entity one) { return session.hidden.count(one) > 0 || session.locked.count(one) > 0; },
                     session.played.get())
                     .entity;
    const ImGuiIO& io = ImGui::GetIO();
    if (entity.is_null()) {
        if (!io.KeyCtrl && !io.KeyShift)
            document.select({});
        return;
    }
    if (io.KeyCtrl || io.KeyShift)
        document.toggle(entity);
    else
        document.select({entity});
}

void Viewport::navigate(Session& session, bool hovered) {
    const app::InputState& input = *session.input;
    const ImGuiIO& io = ImGui::GetIO();
    if (flying_) {
        if (!input.mouse_buttons[1]) {
            flying_ = false;
            session.capture_pointer(false);
            return;
        }
        session.camera.look(input.mouse_motion);
        session.camera.fly(input, std::min(double(io.DeltaTime), longest_step), session.scene_size());
        return;
    }
    if (!hovered)
        return;
    if (input.hit(app::first_mouse_button + 1) && !io.KeyAlt) {
        flying_ = true;
        session.capture_pointer(true);
        return;
    }
    const vec2 motion(io.MouseDelta.x, io.MouseDelta.y);
    if (io.MouseDown[2])
        session.camera.pan(motion, viewport_size(session).y);
    if (io.MouseDown[0] && io.KeyAlt)
        session.camera.orbit(motion);
    if (io.MouseWheel != 0.0f)
        session.camera.dolly(io.MouseWheel, session.scene_size());
}

// Puts what is so wide to the right of the last one, or on a line of its own where the picture ends before.
void beside_or_below(const Session& session, float width, float gap) {
    if (ImGui::GetItemRectMax().x + gap + width < session.viewport_area.x + session.viewport_area.z)
        ImGui::SameLine(0.0f, gap);
}

// A switch of that name.
void beside_or_below(const Session& session, const char* name, float gap) {
    beside_or_below(session, ImGui::CalcTextSize(name, nullptr, true).x + 2.0f * ImGui::GetStyle().FramePadding.x, gap);
}

// Switches in the picture's corner.
void Viewport::play_buttons(Session& session) {
    const auto button = [&](const char* name, const char* command, float gap = 2.0f) {
        beside_or_below(session, name, gap);
        Command& known = *session.commands->find(command);
        if (ui::button(name, known.tooltip))
            session.commands->run(known, session);
    };
    button(session.view.playing ? "Stop##play" : "Play##play", "View/Play", ui::unit());
    if (!session.view.playing)
        return;
    button(session.view.paused ? "Go on##pause" : "Pause##pause", "View/Pause");
    button("Step", "View/Step");
}

// How long the steps of handles are.
void Viewport::step_boxes(Session& session) {
    SnapSteps& steps = session.gizmo.steps;
    const auto box = [&](const char* name, const char* unit, const SnapSteps::Range& range, float& step) {
        ui::NumberLook look;
        look.value = double(step);
        look.minimum = double(range.least);
        look.maximum = double(range.most);
        look.unit = unit;
        look.width = 4.2f * ui::unit();
        beside_or_below(session, look.width, 2.0f);
        const std::string meaning = std::string("Steps of ") + name;
        if (const std::optional<double> value = value_box(session, "step of " + std::string(name), meaning, look))
            step = float(*value);
        ui::tooltip(meaning + ", " + ui::number_text(look.minimum, false) + " to " +
                    ui::number_text(look.maximum, false) + (*unit == '\0' ? "" : " " + look.unit) +
                    "; with Snap on, or Ctrl held");
    };
    box("moves", "m", SnapSteps::lengths, steps.length);
    box("rotations", "\xc2\xb0", SnapSteps::angles, steps.angle);
    box("scales", "x", SnapSteps::factors, steps.factor);
}

void Viewport::toolbar(Session& session) {
    const ImVec4 area = session.viewport_area;
    ImGui::SetCursorScreenPos(ImVec2(area.x + 0.5f * ui::unit(), area.y + 0.5f * ui::unit()));
    ImGui::BeginGroup();
    const auto mode = [&](const char* name, GizmoMode one, const char* tip) {
        const bool on = session.gizmo.mode == one;
        if (one != GizmoMode::none)
            beside_or_below(session, name, 2.0f);
        ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(on ? ImGuiCol_ButtonActive : ImGuiCol_Button));
        if (ui::button(name, tip))
            session.gizmo.mode = one;
        ImGui::PopStyleColor();
    };
    mode("Select", GizmoMode::none, "Click to select (Q)");
    mode("Move", GizmoMode::move, "Drag an arrow, a square or the middle (W); Ctrl snaps");
    mode("Rotate", GizmoMode::rotate, "Drag a ring (E); Ctrl snaps");
    mode("Scale", GizmoMode::scale, "Drag a handle, or the middle for all (R); Ctrl snaps");
    mode("Inspect", GizmoMode::inspect, "Click a pixel: what is there, and what lights it (I, or Alt and a click)");
    const auto toggle = [&](bool& on, const char* name, float gap, const char* tip) {
        beside_or_below(session, name, gap);
        if (ui::button(name, tip))
            on = !on;
    };
    toggle(session.gizmo.local, session.gizmo.local ? "Local##axes" : "World##axes", ui::unit(),
           "Axes of the handles (X)");
    toggle(session.gizmo.snap, session.gizmo.snap ? "Snap on##snap" : "Snap off##snap", 2.0f,
           "Movements in steps; holding Ctrl is the other way about");
    step_boxes(session);
    play_buttons(session);
    ImGui::EndGroup();
    toolbar_low_ = ImGui::GetItemRectMin();
    toolbar_high_ = ImGui::GetItemRectMax();
}

void Viewport::overlay(Session& session) {
    if (session.view.show_grid)
        grid(session);
    find_places(session);
    if (session.view.show_icons)
        for (const Icon& one : icons(session))
            icon(session, one.entity, one.place);
    mark_inspected(session);
    for (const Placed& placed : outlines_)
        outline(session, placed);
}

void Viewport::draw(Session& session, const ScenePicture* picture) {
    const ui::Scope scope("viewport");
    const ImVec2 low = ImGui::GetCursorScreenPos(), room = ImGui::GetContentRegionAvail();
    session.viewport_area =
        ImVec4(low.x, low.y, std::max(std::floor(room.x), 1.0f), std::max(std::floor(room.y), 1.0f));
    ImGui::InvisibleButton("picture", ImVec2(session.viewport_area.z, session.viewport_area.w),
                           ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonMiddle);
    ImGui::SetItemAllowOverlap(); // by the switches over it
    const bool hovered = ImGui::IsItemHovered() && !ImGui::IsMouseHoveringRect(toolbar_low_, toolbar_high_);
    ui::note("picture", picture == nullptr ? "empty" : std::to_string(picture->number));
    const bool active = ImGui::IsItemActive();
    ImGui::PushClipRect(low, ImVec2(low.x + room.x, low.y + room.y), true);
    overlay(session);
    const bool on_split = draw_comparison(session);
    const bool on_gizmo = gizmo_.draw(session, hovered && !flying_ && !on_split) || on_split;
    ImGui::PopClipRect();
    if (hovered && ImGui::IsMouseClicked(0)) {
        pressed_ = ImGui::GetIO().MousePos;
        press_inspects_ = ImGui::GetIO().KeyAlt || session.gizmo.mode == GizmoMode::inspect;
        press_is_click_ = press_inspects_ || !on_gizmo;
    }
    navigate(session, hovered || active);
    if (press_is_click_ && ImGui::IsMouseReleased(0)) {
        press_is_click_ = false;
        const ImVec2 now = ImGui::GetIO().MousePos;
        if (std::hypot(now.x - pressed_.x, now.y - pressed_.y) < 5.0f)
            press_inspects_ ? session.inspect(pointer_in_viewport(session)) : click(session);
    }
    toolbar(session);
    if (session.document->entity_count() == 0 && session.opening == nullptr)
        say_how_to_begin(low, room);
    if (no_lamp_shines(session))
        line_in_picture("no light", "All lamps are hidden or muted; Show, Show all brings them back",
                        ImVec2(low.x + ui::unit(), low.y + room.y - 4.0f * ui::unit()), room.x - 2.0f * ui::unit());
    if (const std::string error = session.scene.status().error; !error.empty()) {
        ImGui::SetCursorScreenPos(ImVec2(low.x + ui::unit(), toolbar_high_.y + ui::unit()));
        ImGui::PushTextWrapPos(room.x - ui::unit());
        ImGui::TextColored(ImVec4(1.0f, 0.5f, 0.42f, 1.0f), "%s", error.c_str());
        ui::note("error", error);
        ImGui::PopTextWrapPos();
    }
}

} // namespace sunfleck::editor

// The commands.
#include "editor/window/commands.h"

#include "editor/document/picking.h"
#include "editor/window/comparison.h"
#include "editor/window/fields.h"
#include "editor/window/opening.h"
#include "editor/window/scene_play.h"
#include "editor/window/switches.h"
#include "editor/window/widgets.h"
#include "engine/scene/entity_templates.h"
#include "viewer/overlays.h"

#include <algorithm>

namespace sunfleck::editor {
namespace {

constexpr bool with_control = true, with_shift = true;

bool has_selection(Session& session) {
    return !session.document->selection().empty();
}

Shortcut control(app::Key key, bool shift = false) {
    return {key, with_control, shift, false};
}

// Where something new is seen: ahead, but not behind what stands there.
vec3 place_ahead(Session& session) {
    const scene::CameraView& view = session.camera.view();
    const vec3 forward = glm::normalize(view.target - view.position);
    const float usual = 0.4f * session.scene_size();
    const Picked hit = pick(*session.document, view.position, forward, {}, session.played.get());
    return view.position + forward * (hit.entity.is_null() ? usual : std::min(usual, 0.75f * hit.distance));
}

void save(Session& session) {
    const std::filesystem::path& path = session.document->path();
    if (path.string().ends_with(".scene.json") && !is_built_in(path))
        session.save_behind();
    else
        session.dialog = Dialog::save_as;
}

void select_all(Session& session) {
    Entities all;
    for (const Entity root : session.document->roots())
        for (const Entity entity : session.document->family(root))
            all.push_back(entity);
    session.document->select(all);
}

void unparent(Session& session) {
    session.messages.check(reparent(*session.document, session.selected_tops(), ecs::null_entity));
}

// From where nothing stands between: in a room that is not so far off that all of a wall would be seen, but before the
// wall behind.
void look_at_selection(Session& session) {
    Document& document = *session.document;
    const Bounds bounds =
        has_selection(session) ? bounds_of(document, session.selected_tops()) : bounds_of_all(document);
    session.camera.frame(bounds);
    if (!has_selection(session) || bounds.empty())
        return;
    scene::CameraView view = session.camera.view();
    const vec3 back = view.position - view.target;
    std::unordered_set<Entity> selected;
    for (const Entity top : session.selected_tops())
        for (const Entity entity : document.family(top))
            selected.insert(entity);
    const Picked hit = pick(
        document, view.target, glm::normalize(back),
        [&](Entity one) { return selected.count(one) > 0 || session.hidden.count(one) > 0; }, session.played.get());
    const float nearest = 0.1f * glm::length(bounds.extent()); // else something stands right before it
    if (hit.entity.is_null() || 0.95f * hit.distance > glm::length(back) || 0.95f * hit.distance < nearest)
        return;
    view.position = view.target + glm::normalize(back) * (0.95f * hit.distance);
    session.camera.set(view);
}

} // namespace

void add_file_commands(std::vector<Command>& list) {
    list.push_back({"File", "New", "An empty scene", control('N'), [](Session& session) {
                        session.unless_unsaved([&session] { session.take(std::make_shared<Document>()); });
                    }});
    list.push_back({"File", "Open...", "A .gltf, .glb or .scene.json file; files may also be dropped on the window",
                    control('O'), [](Session& session) { session.dialog = Dialog::open; }});
    list.push_back({"File", "Reload",
                    "Takes over what other programs have changed in the file that the scene came from; edits stay with "
                    "the nodes of the same name, and undo takes it all back",
                    control('R'), [](Session& session) { session.reload_file(); },
                    [](Session& session) { return session.can_reload(); }});
    list.push_back({"File", "Save", "Writes a .scene.json file, with geometry and settings", control('S'), save});
    list.push_back({"File", "Save as...", "", control('S', with_shift),
                    [](Session& session) { session.dialog = Dialog::save_as; }});
    list.push_back({"File", "Quit", "", control('Q'),
                    [](Session& session) { session.unless_unsaved([&session] { session.quit = true; }); }});
}

void add_edit_commands(std::vector<Command>& list) {
    list.push_back({"Edit", "Undo", "", control('Z'), [](Session& session) { session.document->undo(); },
                    [](Session& session) { return session.document->history().can_undo(); }});
    list.push_back({"Edit", "Redo", "", control('Z', with_shift), [](Session& session) { session.document->redo(); },
                    [](Session& session) { return session.document->history().can_redo(); }});
    list.push_back({"Edit",
                    "Delete",
                    "The selection, with all that is below it; what is locked stays",
                    {app::key_delete},
                    delete_selection,
                    has_selection});
    list.push_back({"Edit",
                    "Rename",
                    "In the hierarchy, where a double click asks for a name, too",
                    {app::key_f1 + 1},
                    [](Session& session) {
                        session.to_rename = session.document->selection()[0];
                        session.front = "Hierarchy";
                    },
                    [](Session& session) { return session.document->selection().size() == 1; }});
    list.push_back({"Edit", "Duplicate", "", control('D'),
                    [](Session& session) { duplicate(*session.document, session.document->selection()); },
                    has_selection});
    list.push_back({"Edit", "Group", "Puts the selection under a new entity", control('G'),
                    [](Session& session) { group(*session.document, session.document->selection()); }, has_selection});
    list.push_back({"Edit", "Move to top", "Out of what it is below; its place in the world stays",
                    control('G', with_shift), unparent, has_selection});
    list.push_back({"Edit", "Select all", "", control('A'), select_all});
    list.push_back({"Edit",
                    "Select none",
                    "",
                    {app::key_escape},
                    [](Session& session) { session.document->select({}); },
                    has_selection});
}

void add_show_commands(std::vector<Command>& list) {
    list.push_back({"Show",
                    "Hide",
                    "The selection and what is below it, light included; the file keeps it",
                    {'H'},
                    [](Session& session) { set_hidden(session, session.document->selection(), true); },
                    has_selection});
    list.push_back({"Show",
                    "Show all",
                    "Lamps that are muted, too",
                    {'H', false, with_shift},
                    [](Session& session) {
                        session.hidden.clear();
                        session.muted.clear();
                    },
                    [](Session& session) { return !session.hidden.empty() || !session.muted.empty(); }});
    list.push_back({"Show",
                    "Mute lamps",
                    "Those of the selection and below give no light; they stay in the picture, and the file keeps them "
                    "as they are. Once more: they shine",
                    {'M'},
                    toggle_mute,
                    has_selection,
                    is_muted});
    list.push_back({"Show",
                    "Solo lamps",
                    "Light from the selection and what is below it alone; once more: as before",
                    {'L'},
                    toggle_solo,
                    [](Session& session) { return has_selection(session) || is_solo(session); },
                    is_solo});
    list.push_back({"Show", "Lock",
                    "Clicks in the picture, handles and Delete leave the selection and what is below it alone; once "
                    "more: not",
                    control('L'), toggle_lock, has_selection, is_locked});
}

void add_gizmo_commands(std::vector<Command>& list) {
    const auto mode = [&](const char* name, const char* tip, app::Key key, GizmoMode one) {
        list.push_back({"Tools",
                        name,
                        tip,
                        {key},
                        [one](Session& session) { session.gizmo.mode = one; },
                        {},
                        [one](Session& session) { return session.gizmo.mode == one; }});
    };
    mode("Select", "Without handles", 'Q', GizmoMode::none);
    mode("Move", "Handles that move the selection", 'W', GizmoMode::move);
    mode("Rotate", "Rings that rotate the selection", 'E', GizmoMode::rotate);
    mode("Scale", "Handles that scale the selection", 'R', GizmoMode::scale);
    mode("Inspect", "Clicks look into a pixel: its surface, and which light gives it how much", 'I',
         GizmoMode::inspect);
    list.push_back({"Tools",
                    "Local axes",
                    "Handles along the axes of what is selected last",
                    {'X'},
                    [](Session& session) { session.gizmo.local = !session.gizmo.local; },
                    {},
                    [](Session& session) { return session.gizmo.local; }});
    list.push_back({"Tools",
                    "Snap",
                    "Movements in steps; holding Ctrl is the other way about",
                    {},
                    [](Session& session) { session.gizmo.snap = !session.gizmo.snap; },
                    {},
                    [](Session& session) { return session.gizmo.snap; }});
}

void add_template_commands(std::vector<Command>& list) {
    for (const scene::EntityTemplate& source : scene::entity_templates())
        list.push_back({"Add", std::string(source.name), std::string(source.tooltip), {}, [&source](Session& session) {
                            add_from(*session.document, source, place_ahead(session), 0.1f * session.scene_size());
                            session.front = "Inspector"; // where it is changed next, or by handles
                            if (session.gizmo.mode == GizmoMode::none || session.gizmo.mode == GizmoMode::inspect)
                                session.gizmo.mode = GizmoMode::move;
                        }});
}

void add_overlay_commands(std::vector<Command>& list) {
    for (const gi::Overlay* overlay : viewer::overlays()) {
        const std::string name(overlay->name);
        list.push_back({"Overlays",
                        readable_name(name),
                        std::string(overlay->tooltip) + "\nColours: " + std::string(overlay->legend),
                        {},
                        [name](Session& session) { session.view.toggle_overlay(name); },
                        {},
                        [name](Session& session) { return session.view.has_overlay(name); }});
    }
}

void play_or_stop(Session& session) {
    session.view.playing = !session.view.playing;
    session.view.paused = false;
    if (session.view.playing && !ScenePlay::would_move(session.document->registry()))
        session.messages.say("Nothing moves in this scene: it has no movers on the clock, animations or rigid bodies");
}

void add_play_commands(std::vector<Command>& list) {
    list.push_back({"View",
                    "Play",
                    "Movers move and bodies fall; stopped, all is as it was edited",
                    control(app::key_space),
                    play_or_stop,
                    {},
                    [](Session& session) { return session.view.playing; }});
    list.push_back({"View",
                    "Pause",
                    "What plays stands still; again: it goes on",
                    {app::key_f1 + 5},
                    [](Session& session) { session.view.paused = !session.view.paused; },
                    [](Session& session) { return session.view.playing; },
                    [](Session& session) { return session.view.paused; }});
    list.push_back(
        {"View", "Step", "Plays a sixtieth of a second, then pauses", {app::key_f1 + 6}, [](Session& session) {
             session.view.playing = session.view.paused = true;
             session.scene.step(1);
         }});
}

void add_view_commands(std::vector<Command>& list) {
    list.push_back(
        {"View", "Look at selection", "Or at the whole scene, if nothing is selected", {'F'}, look_at_selection});
    list.push_back({"View",
                    "Expose again",
                    "By the picture as it is now; a scene that says its own exposure keeps that",
                    {},
                    [](Session& session) {
                        session.view.ev100.reset();
                        ++session.view.exposures;
                    }});
    list.push_back({"View", "Look at everything", "", {app::key_home}, [](Session& session) {
                        session.camera.frame(bounds_of_all(*session.document));
                    }});
    list.push_back(
        {"View",
         "Grid",
         "Squares on the ground, as large as the scene asks for",
         {},
         [](Session& session) { session.view.show_grid = !session.view.show_grid; },
         {},
         [](Session& session) { return session.view.show_grid; },
         [](Session& session) { return "Grid, " + ui::number_text(double(session.grid_step()), false) + " m"; }});
    list.push_back({"View",
                    "Icons",
                    "Of lamps, cameras and groups, which have no geometry",
                    {},
                    [](Session& session) { session.view.show_icons = !session.view.show_icons; },
                    {},
                    [](Session& session) { return session.view.show_icons; }});
    list.push_back({"View", "Usual panel sizes", "As large as they are at first", {}, [](Session& session) {
                        session.usual_layout = true;
                    }});
    list.push_back({"View",
                    "Flip",
                    "The scene, or what it is compared with",
                    {'T'},
                    [](Session& session) {
                        session.comparison->as = CompareAs::flip;
                        session.comparison->flipped = !session.comparison->flipped;
                    },
                    [](Session& session) { return session.comparison->on(); },
                    [](Session& session) { return session.comparison->flipped; }});
    add_play_commands(list);
    list.push_back({"View",
                    "Rebuild the lighting",
                    "From nothing, as when the saved scene is opened",
                    {app::key_f1 + 4},
                    [](Session& session) { session.rebuild = true; }});
}

} // namespace sunfleck::editor

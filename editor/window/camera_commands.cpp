// Commands about the scene's cameras: views that are kept, gone to and changed.
#include "editor/window/commands.h"

#include "editor/document/bookmarks.h"

namespace sunfleck::editor {
namespace {

constexpr std::size_t numbered = 9;

Entity selected_camera(Session& session) {
    const std::vector<Entity>& selection = session.document->selection();
    return selection.size() == 1 && is_camera(*session.document, selection[0]) ? selection[0] : ecs::null_entity;
}

bool has_camera(Session& session) {
    return !selected_camera(session).is_null();
}

void go_to(Session& session, Entity camera) {
    const float distance = glm::length(session.camera.view().target - session.camera.view().position);
    session.camera.set(scene::camera_view(session.document->registry(), camera, std::max(distance, 1e-3f)));
}

void add_numbered(std::vector<Command>& list, std::size_t number) {
    const auto entity = [number](Session& session) {
        const Entities all = cameras(*session.document);
        return number < all.size() ? all[number] : ecs::null_entity;
    };
    const std::string digit = std::to_string(number + 1);
    Command command{"Cameras",
                    "Camera " + digit,
                    "Sees what this camera of the scene sees; rename it in the inspector",
                    {app::Key('1' + number)},
                    [entity](Session& session) { go_to(session, entity(session)); },
                    [entity](Session& session) { return !entity(session).is_null(); }};
    command.title = [entity, digit](Session& session) {
        const Entity camera = entity(session);
        return digit + "  " + (camera.is_null() ? "(none)" : session.document->name(camera));
    };
    list.push_back(std::move(command));
}

} // namespace

void add_camera_commands(std::vector<Command>& list) {
    list.push_back({"Cameras",
                    "Keep this view",
                    "Adds a camera that sees what the viewport shows; it is saved with the scene",
                    {'B', true},
                    [](Session& session) { add_camera(*session.document, session.camera.view()); }});
    list.push_back({"Cameras",
                    "Look through the selected one",
                    "",
                    {'B'},
                    [](Session& session) { go_to(session, selected_camera(session)); },
                    has_camera});
    list.push_back(
        {"Cameras",
         "Move the selected one here",
         "It sees what the viewport shows from now on",
         {'B', true, true},
         [](Session& session) { move_camera(*session.document, selected_camera(session), session.camera.view()); },
         has_camera});
    for (std::size_t number = 0; number < numbered; ++number)
        add_numbered(list, number);
}

} // namespace sunfleck::editor

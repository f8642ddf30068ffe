#include "editor/document/bookmarks.h"

namespace sunfleck::editor {
namespace {

// Along its local -Z axis.
mat4 place_of_camera(const scene::CameraView& view) {
    const shared::CameraRow row = scene::make_camera_row(view, 1, 1);
    const vec3 forward(row.axis), right = glm::normalize(vec3(row.right)), up = -glm::normalize(vec3(row.down));
    return {vec4(right, 0.0f), vec4(up, 0.0f), vec4(-forward, 0.0f), vec4(view.position, 1.0f)};
}

// Within a gesture.
void set_view(Document& document, Entity camera, const scene::CameraView& view) {
    auto lens = std::make_shared<scene::Camera>();
    lens->vertical_field_of_view = view.vertical_field_of_view;
    document.set(camera, pool_of<scene::Camera>(document), std::move(lens));
    set_world(document, camera, place_of_camera(view));
}

} // namespace

Entities cameras(Document& document) {
    Entities result;
    for (const Entity root : document.roots())
        for (const Entity entity : document.family(root))
            if (is_camera(document, entity))
                result.push_back(entity);
    return result;
}

bool is_camera(Document& document, Entity entity) {
    return document.exists(entity) && document.registry().has<scene::Camera>(entity) &&
           document.registry().has<scene::Transform>(entity);
}

Entity add_camera(Document& document, const scene::CameraView& view) {
    document.begin("Add camera");
    const Entity camera = document.create();
    auto name = std::make_shared<scene::Name>();
    name->name = document.free_name("view 1");
    document.set(camera, pool_of<scene::Name>(document), std::move(name));
    document.set(camera, pool_of<scene::Transform>(document), std::make_shared<scene::Transform>());
    set_view(document, camera, view);
    document.select({camera});
    document.commit();
    return camera;
}

void move_camera(Document& document, Entity camera, const scene::CameraView& view) {
    if (!is_camera(document, camera))
        return;
    document.begin("Move " + document.name(camera) + " here");
    set_view(document, camera, view);
    document.commit();
}

} // namespace sunfleck::editor

// Views that are kept: cameras of the scene, so that they are saved with it, have names, can be undone, and are known
// to every other program (`render --camera NAME`).
#pragma once

#include "editor/document/edits.h"
#include "engine/scene/camera_view.h"

namespace sunfleck::editor {

// All cameras, in the order of the hierarchy.
Entities cameras(Document& document);
// A new camera that sees this; it is selected.
Entity add_camera(Document& document, const scene::CameraView& view);
// Makes a camera of the scene see this.
void move_camera(Document& document, Entity camera, const scene::CameraView& view);
bool is_camera(Document& document, Entity entity);

} // namespace sunfleck::editor

// What lies over the viewport while two pictures are compared.
#pragma once

#include "editor/window/session.h"

namespace sunfleck::editor {

// The line between the two, which can be dragged, what they are, and what colours of errors mean. True if the pointer
// is on the line.
bool draw_comparison(Session& session);

} // namespace sunfleck::editor

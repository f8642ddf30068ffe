// Numbers that are of no document: budgets, steps of handles, what the viewport shows. Dragged or typed.
#pragma once

#include "editor/window/session.h"
#include "editor/window/widgets.h"

namespace sunfleck::editor {

// What was typed into a box, where it is a number of its range; else it is said, once, what the box takes. `meaning`:
// what the number is of.
std::optional<double> typed_value(Session& session, const std::string& meaning, const std::string& text,
                                  const ui::NumberLook& look);
// A box, and its new value where it has got one. Escape in the middle of a drag gives back the one before.
std::optional<double> value_box(Session& session, const std::string& name, const std::string& meaning,
                                const ui::NumberLook& look);

} // namespace sunfleck::editor

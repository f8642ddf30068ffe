// Rows for described values, of components and settings alike: name, widget by kind, unit, range, tooltip and reset,
// all from the description.
#pragma once

#include "editor/window/session.h"

namespace sunfleck::editor {

// A described value where it is kept. Several that differ are shown as mixed and set together.
struct FieldSource {
    const Field* field = nullptr;
    std::vector<const void*> objects; // the structs that hold it; at least one
    const void* defaults = nullptr;   // such a struct with default values; null: there is no reset
    std::string gesture;              // name of the history's entry
    // Sets it in an object, within a gesture.
    std::function<Status(std::size_t object, const std::string& text)> set;
    bool in_document = true; // whose gestures take it back; else a drag that is given up does it here
};

// One gesture that gives every object a text; what is wrong with it is said, and nothing changes then.
void apply_field_text(Session& session, const FieldSource& source,
                      const std::function<std::string(const void* object)>& text);

// "base_colour" -> "Base colour"
std::string readable_name(std::string_view name);

// Rows go between these two. `names`: their share of the width, where that is enough for both.
bool begin_fields(const char* id, float names = 0.4f);
void end_fields();
void field_row(Session& session, const FieldSource& source);

} // namespace sunfleck::editor

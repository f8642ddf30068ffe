// Described values as the numbers that are shown: angles in degrees, rotations as three angles.
#pragma once

#include "editor/window/angles.h"
#include "engine/core/description.h"

#include <optional>

namespace sunfleck::editor {

// 0: it is not made of numbers.
int number_of_parts(const Field& field);
// The unit that is shown, and how many of it are one of the description's.
std::string shown_unit(const Field& field);
double shown_factor(const Field& field);
// In the unit that is shown.
double read_part(const Field& field, const void* object, int part);
// The value as text, with one part replaced. `object` is not changed.
std::string text_with_part(const Field& field, const void* object, int part, double value);
// The same while a part is dragged. Rotations go on from the angles before the drag: past 90 degrees, what has been
// reached would be told by other angles than those that led there.
class PartDrag {
public:
    PartDrag() = default;
    PartDrag(const Field& field, const std::vector<const void*>& objects, int part);
    std::string text(const Field& field, const void* object, std::size_t index, double value) const;

private:
    int part_ = 0;
    std::vector<Angles> angles_; // of rotations, an object each
};
// The same with what is no number; a text with commas is the whole value.
std::string text_with_part(const Field& field, const void* object, int part, const std::string& text);
// What somebody has typed as a number; none where it is not one, all of it, or not finite.
std::optional<double> typed_number(const std::string& text);
// Values of light or colour, which have a colour picker.
bool is_colour(const Field& field);
vec3 colour_of(const Field& field, const void* object);
std::string colour_text(vec3 colour);
// Tooltip, range, unit and default.
std::string field_help(const Field& field, const void* defaults);

} // namespace sunfleck::editor

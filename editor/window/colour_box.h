// A sample of a colour, and the picker behind it: hue and saturation, intensity, colour temperature, photometric units.
#pragma once

#include "editor/window/fields.h"

namespace sunfleck::editor {

void colour_cell(Session& session, const FieldSource& source);

inline constexpr float coldest_body = 1667.0f, hottest_body = 25000.0f; // K
// Linear Rec. 709 of a black body at a temperature (K) between these, brightest component 1. Planckian locus by the
// rational fit of Kang et al., "Design of advanced color temperature control system for HDTV applications", 2002.
vec3 black_body_colour(float kelvin);
// The inverse, for colours near the locus: the correlated colour temperature. None where no black body of the range
// above comes as close as CIE 15 demands of one, which is 0.05 in the diagram of 1960.
std::optional<float> colour_temperature(vec3 colour);

// The photometric unit of a radiometric one; "": it has none.
std::string photometric_unit(std::string_view unit);

} // namespace sunfleck::editor

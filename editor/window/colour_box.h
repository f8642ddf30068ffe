// A sample of a colour, and the picker behind it: hue and saturation, intensity, colour temperature, photometric units.
#pragma once

#include "editor/window/fields.h"

namespace sunfleck::editor {

void colour_cell(Session& session, const FieldSource& source);

// Linear Rec. 709 of a black body at a temperature (K), brightest component 1. Planckian locus by the rational fit of
// Kang et al., "Design of advanced color temperature control system for HDTV applications", 2002; 1,667 to 25,000 K.
vec3 black_body_colour(float kelvin);

} // namespace sunfleck::editor

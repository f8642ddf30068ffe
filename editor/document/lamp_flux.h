// What lamps give in all, for whoever thinks in lumens.
#pragma once

#include "engine/core/description.h"

namespace sunfleck::editor {

// W that the lamp radiates in all directions for each unit of the field, which says how strong it is: sr for a point
// light or a spot (W/sr), m2 sr for an area light (W/(sr m2)). 0: the field is none of these. `object`: the component.
double flux_per_unit(const Field& field, const void* object);

} // namespace sunfleck::editor

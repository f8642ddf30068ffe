// Views of a part of the light, whichever techniques give it: what comes straight from lamps, and what surfaces
// reflect. The picture is lit as always, by less.
#pragma once

#include "gi_module/transport/light_plan.h"
#include "gi_module/transport/report.h"

#include <span>

namespace sunfleck::gi {

std::span<const DebugView> light_part_views();
// The diffuse light that the view shows.
CellSet cells_of(const DebugView& light_part_view);

} // namespace sunfleck::gi

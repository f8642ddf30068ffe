// Which nodes of the visibility database a view may show, and which lights need shadow tests there.
#pragma once

#include "gi_module/many_light/pass_grouping.h"
#include "gi_module/visibility/view_bounds.h"
#include "gi_module/visibility/visibility_database.h"

namespace sunfleck::gi {

// By leaf or mover that the view may show: the samples in state "partial", and with `extras` those that are harmless to
// test in addition (all but the blocked ones).
std::map<std::uint32_t, PassLights> tested_lights_of_visible_nodes(const VisibilityDatabase& database,
                                                                   const mat4& view_projection, bool extras);

} // namespace sunfleck::gi

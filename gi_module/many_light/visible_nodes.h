// Which nodes of the visibility database a view may show, and with which lights they need shadow tests.
#pragma once

#include "gi_module/many_light/pass_grouping.h"
#include "gi_module/visibility/view_bounds.h"
#include "gi_module/visibility/visibility_database.h"

namespace sunfleck::gi {

// Of the leaves and movers that the view may show: the samples in state "partial", and with `extras` those that are
// harmless to test besides (all but the blocked ones), by node.
std::map<std::uint32_t, PassLights> tested_lights_of_visible_nodes(const VisibilityDatabase& database,
                                                                   const mat4& view_projection, bool extras);

} // namespace sunfleck::gi

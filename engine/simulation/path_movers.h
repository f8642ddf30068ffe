// Movers on paths, as a pure function of the step: the same step gives the same poses, whatever came before.
#pragma once

#include "engine/scene/components.h"

namespace sunfleck::simulation {

inline constexpr double step_seconds = 1.0 / 60.0;

// Puts every Mover at its pose of step `step` and updates world transforms. Entities whose pose is the same keep their
// change tick.
void set_movers_to_step(ecs::Registry& registry, std::uint64_t step);

} // namespace sunfleck::simulation

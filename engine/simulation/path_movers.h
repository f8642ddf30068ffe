// Movers on paths, as a pure function of the step: the same step gives the same poses, regardless of history.
#pragma once

#include "engine/scene/components.h"

namespace sunfleck::simulation {

inline constexpr double step_seconds = 1.0 / 60.0;

// Sets every Mover to its pose at `step` and updates world transforms. Entities whose pose is unchanged keep their
// change tick.
void set_movers_to_step(ecs::Registry& registry, std::uint64_t step);

} // namespace sunfleck::simulation

// Movers on paths, as a pure function of the step: the same step gives the same poses, regardless of history.
#pragma once

#include "engine/scene/components.h"

namespace sunfleck::simulation {

inline constexpr double step_seconds = 1.0 / 60.0;

// Sets every Mover to its pose at `step` and updates world transforms. Entities whose pose is unchanged keep their
// change tick.
void set_movers_to_step(ecs::Registry& registry, std::uint64_t step);

// Where the mover's origin is in the world at `count` moments of one cycle (activated: of the way to its far end), the
// first and the last included. Empty if it has no path.
std::vector<vec3> mover_path(const ecs::Registry& registry, ecs::Entity entity, std::uint32_t count);

} // namespace sunfleck::simulation

// Turning to a target, as the built-in walk and the game's solution do.
#pragma once

#include "engine/simulation/simulation.h"

namespace sunfleck::demo {

// A step's turn towards the target, at most 2.7 rad/s and slower near the end. `off`: the larger of the angles that are
// left, rad.
simulation::StepInput turn_to(const simulation::Character& person, vec3 target, float& off);

} // namespace sunfleck::demo

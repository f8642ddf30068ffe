// What a saved game relies on of its level.
#pragma once

#include "engine/ecs/registry.h"

namespace sunfleck::demo {

// A hash of the freshly loaded level's named entities: their names, parents, places and kinds of components. A game
// that was saved in a level with another one would be put onto entities that it knows nothing of.
std::string contents_of_level(ecs::Registry& registry);

} // namespace sunfleck::demo

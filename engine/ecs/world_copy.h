// A registry's content in another registry, whatever its components are.
#pragma once

#include "engine/ecs/registry.h"

namespace sunfleck::ecs {

// `to` has the entities of `from` afterwards, by the same handles, with the same components, in the same order where
// `to` was empty. Whatever else it had is removed. Components that can't be copied are left out, and components of
// which `to` has the same value count as changed all the same. Neither registry may be within a loop.
void copy_world(Registry& from, Registry& to);

} // namespace sunfleck::ecs

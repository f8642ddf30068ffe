// Serialises the described components of a registry and restores them.
#pragma once

#include "engine/core/result.h"
#include "engine/ecs/registry.h"

#include <string>
#include <unordered_map>

namespace sunfleck::ecs {

// Maps each saved handle to the restored entity.
using EntityMap = std::unordered_map<EntityBits, Entity>;

// All living entities and their described components, fields by name, in pool order.
std::string save_snapshot(Registry& registry);

// Adds the snapshot's entities to `registry` as new ones; fields that hold entities are remapped to the new handles (to
// null where they point outside the snapshot). Component types must be registered. Unknown types or fields, other
// versions and damaged data are errors that leave the registry unchanged.
Result<EntityMap> restore_snapshot(Registry& registry, std::string_view bytes);

} // namespace sunfleck::ecs

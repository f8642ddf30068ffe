// Saves the described components of a registry to bytes and brings them back.
#pragma once

#include "engine/core/result.h"
#include "engine/ecs/registry.h"

#include <string>
#include <unordered_map>

namespace sunfleck::ecs {

// Old handle (as saved) to the entity that now stands for it.
using EntityMap = std::unordered_map<EntityBits, Entity>;

// All living entities and their described components, fields by name, in the order of their pools.
std::string save_snapshot(Registry& registry);

// Adds the snapshot's entities to `registry` as new ones; fields that hold entities are mapped to the new handles (to
// null where they point outside the snapshot). Component types must be registered; a type or field that this build does
// not know, another version, or damaged bytes are an error, and then the registry is as it was.
Result<EntityMap> restore_snapshot(Registry& registry, std::string_view bytes);

} // namespace sunfleck::ecs

// Components as JSON in scene files, by name of entity, component and field. Not for use outside this folder.
#pragma once

#include "engine/core/description.h"
#include "engine/ecs/registry.h"

#include <functional>
#include <nlohmann/json_fwd.hpp>

namespace sunfleck::io {

// Version 1 had no checksums and no settings, version 2 no source. Files without one stay readable for programs that
// know version 2.
inline constexpr int scene_file_version = 3, version_without_source = 2;

// Access to one component type by name.
struct ComponentAccess {
    const TypeDescription& type;
    const void* (*find)(ecs::Registry&, ecs::Entity);
    Status (*set)(ecs::Registry&, ecs::Entity, const std::function<Status(void*)>& fill);
    Status (*check)(const std::function<Status(void*)>& fill); // whether `set` would work
    void (*remove)(ecs::Registry&, ecs::Entity);               // it need not have one
};

// Components that glTF cannot express.
const std::vector<ComponentAccess>& saved_components();
// Components that glTF can express but a user may have changed: saved when the scene refers to a glTF file that is not
// written.
const std::vector<ComponentAccess>& overridden_components();

// Whether apply_entity would succeed.
Status check_entity(const std::string& name, const nlohmann::json& components);
// After check_entity. Names that are not nodes create entities that only the scene file has; a component that is null
// is one that the entity does not have.
Status apply_entity(ecs::Registry& registry, const std::string& name, const nlohmann::json& components);
// The components of all named entities; `overridden`: also those that glTF can express. `exact`: also that an entity
// has no place or no material where a node of glTF has one, and materials of entities without geometry.
nlohmann::json entities_json(ecs::Registry& registry, bool overridden, bool exact);

} // namespace sunfleck::io

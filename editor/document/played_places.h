// Where a scene in motion has its entities, as a picture shows them; the document only knows where they were edited to
// be.
#pragma once

#include "engine/ecs/registry.h"
#include "engine/scene/components.h"

#include <vector>

namespace sunfleck::editor {

class PlayedPlaces {
public:
    // Of all that has been placed in the world.
    explicit PlayedPlaces(ecs::Registry& registry) {
        registry.view<scene::WorldTransform>().each([&](ecs::Entity entity, const scene::WorldTransform& world) {
            if (entity.index >= places_.size())
                places_.resize(std::size_t(entity.index) + 1, {ecs::null_entity, mat4(1.0f)});
            places_[entity.index] = {entity, world.matrix};
        });
    }
    // Null: it is not known, for instance because it was not there yet.
    const mat4* find(ecs::Entity entity) const {
        const bool known = entity.index < places_.size() && places_[entity.index].first == entity;
        return known ? &places_[entity.index].second : nullptr;
    }

private:
    std::vector<std::pair<ecs::Entity, mat4>> places_; // by Entity::index
};

} // namespace sunfleck::editor

#include "game_demo/game/level_contents.h"

#include "engine/core/hash.h"
#include "engine/scene/components.h"

#include <algorithm>

namespace sunfleck::demo {
namespace {

// Anything into one hash, strings with their ends.
class Contents {
public:
    void add(std::string_view text) {
        hash_ = hash_bytes(hash_, text.data(), text.size());
        hash_ = hash_bytes(hash_, "", 1);
    }
    void add(float value) {
        value += 0.0f; // files keep no negative zeros
        hash_ = hash_bytes(hash_, &value, sizeof value);
    }
    std::string text() const { return hash_text(hash_); }

private:
    std::uint64_t hash_ = hash_start;
};

void add_place(Contents& contents, const scene::Transform& place) {
    for (int i = 0; i < 3; ++i)
        contents.add(place.position[i]);
    for (int i = 0; i < 4; ++i)
        contents.add(place.rotation[i]);
    for (int i = 0; i < 3; ++i)
        contents.add(place.scale[i]);
}

std::string_view called(const ecs::Registry& registry, ecs::Entity entity) {
    const auto* name = registry.alive(entity) ? registry.try_get<scene::Name>(entity) : nullptr;
    return name != nullptr ? std::string_view(name->name) : std::string_view();
}

} // namespace

std::string contents_of_level(ecs::Registry& registry) {
    std::vector<ecs::Entity> named;
    registry.view<scene::Name>().each([&](ecs::Entity entity, const scene::Name&) { named.push_back(entity); });
    std::sort(named.begin(), named.end(), [&](ecs::Entity a, ecs::Entity b) {
        const std::string_view of_a = called(registry, a), of_b = called(registry, b);
        return of_a != of_b ? of_a < of_b : a < b;
    });
    const std::vector<ecs::PoolBase*> pools = registry.described_pools();
    Contents contents;
    for (const ecs::Entity entity : named) {
        contents.add(called(registry, entity));
        if (const auto* parent = registry.try_get<scene::Parent>(entity))
            contents.add(called(registry, parent->parent));
        if (const auto* place = registry.try_get<scene::Transform>(entity))
            add_place(contents, *place);
        for (const ecs::PoolBase* pool : pools)
            if (!pool->is_derived() && pool->contains(entity))
                contents.add(pool->description()->name);
    }
    return contents.text();
}

} // namespace sunfleck::demo

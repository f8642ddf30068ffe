// Loops over the entities that have all of several components.
#pragma once

#include "engine/ecs/pool.h"

#include <tuple>

namespace sunfleck::ecs {

// Counts the active loops of a registry; deferred changes wait until the outermost one has ended (Registry::defer).
class IterationScope {
public:
    explicit IterationScope(Registry& registry);
    ~IterationScope();
    IterationScope(const IterationScope&) = delete;
    IterationScope& operator=(const IterationScope&) = delete;

private:
    Registry& registry_;
};

// Read-only loop over Ts, in the order of the smallest pool (the first of equals), which makes it deterministic. Pools
// filled side by side are walked in step: an element's index in one pool predicts its index in the next, and the sparse
// look-up is needed only where the prediction fails.
template <typename... Ts>
class View {
public:
    View(Registry& registry, const Pool<Ts>*... pools) : registry_(registry), pools_(pools...) {}

    // body(Entity, const Ts&...)
    template <typename Body>
    void each(Body&& body) const {
        if ((... || (std::get<const Pool<Ts>*>(pools_) == nullptr)))
            return;
        const IterationScope scope(registry_);
        each_led_by_smallest(body, std::index_sequence_for<Ts...>());
    }

    std::size_t count() const {
        std::size_t total = 0;
        each([&](Entity, const Ts&...) { ++total; });
        return total;
    }

private:
    template <typename Body, std::size_t... I>
    void each_led_by_smallest(Body& body, std::index_sequence<I...>) const {
        std::size_t lead = 0;
        std::size_t smallest = std::size_t(-1);
        ((std::get<I>(pools_)->size() < smallest ? (smallest = std::get<I>(pools_)->size(), lead = I) : 0), ...);
        ((lead == I ? (each_led_by<I>(body, std::index_sequence<I...>()), 0) : 0), ...);
    }

    template <std::size_t Lead, typename Body, std::size_t... I>
    void each_led_by(Body& body, std::index_sequence<I...>) const {
        const auto& entities = std::get<Lead>(pools_)->entities();
        const std::tuple<const Ts*...> values(std::get<I>(pools_)->data()...);
        std::uint32_t places[sizeof...(Ts)] = {};
        for (std::size_t i = 0; i < entities.size(); ++i) {
            const Entity entity = entities[i];
            places[Lead] = std::uint32_t(i);
            if ((... && (I == Lead || find(*std::get<I>(pools_), entity, places[I])))) {
                body(entity, std::get<I>(values)[places[I]]...);
                ((++places[I]), ...);
            }
        }
    }

    static bool find(const PoolBase& pool, Entity entity, std::uint32_t& place) {
        const auto& entities = pool.entities();
        if (place < entities.size() && entities[place] == entity)
            return true;
        const std::uint32_t position = pool.position_of(entity.index);
        if (position == PoolBase::absent)
            return false;
        place = position;
        return true;
    }

    Registry& registry_;
    std::tuple<const Pool<Ts>*...> pools_;
};

// An owning group: the pools of Ts keep the entities that have all of them at the front, in the same order, so that a
// loop runs over plain arrays. A pool belongs to at most one group. Created by Registry::group.
class GroupBase {
public:
    explicit GroupBase(std::vector<PoolBase*> pools) : pools_(std::move(pools)) {
        for (PoolBase* pool : pools_) {
            assert(pool->owner == nullptr && "a pool belongs to at most one group");
            pool->owner = this;
        }
        const std::vector<Entity> entities = pools_.front()->entities();
        for (const Entity entity : entities)
            entity_gained(entity);
    }

    std::size_t size() const { return size_; }
    const std::vector<PoolBase*>& pools() const { return pools_; }

    void entity_gained(Entity entity) {
        for (const PoolBase* pool : pools_)
            if (!pool->contains(entity))
                return;
        for (PoolBase* pool : pools_)
            pool->swap_positions(pool->position_of(entity.index), std::uint32_t(size_));
        ++size_;
    }
    // Called before the component is removed.
    void entity_losing(Entity entity) {
        if (pools_.front()->position_of(entity.index) >= size_)
            return;
        --size_;
        for (PoolBase* pool : pools_)
            pool->swap_positions(pool->position_of(entity.index), std::uint32_t(size_));
    }

private:
    std::vector<PoolBase*> pools_;
    std::size_t size_ = 0;
};

template <typename... Ts>
class Group {
public:
    Group(Registry& registry, const GroupBase& base, const Pool<Ts>*... pools)
        : registry_(registry), base_(base), pools_(pools...) {}

    // body(Entity, const Ts&...)
    template <typename Body>
    void each(Body&& body) const {
        const IterationScope scope(registry_);
        const Entity* entities = std::get<0>(pools_)->entities().data();
        const std::tuple<const Ts*...> values(std::get<const Pool<Ts>*>(pools_)->data()...);
        const std::size_t count = base_.size();
        for (std::size_t i = 0; i < count; ++i)
            body(entities[i], std::get<const Ts*>(values)[i]...);
    }
    std::size_t size() const { return base_.size(); }

private:
    Registry& registry_;
    const GroupBase& base_;
    std::tuple<const Pool<Ts>*...> pools_;
};

} // namespace sunfleck::ecs

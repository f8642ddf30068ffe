// The world: entities and their components.
//
// Names tell the contract: `get` requires the component, `try_get` may return null, `emplace` requires that it is
// absent. Reading is const everywhere; writing goes through `patch`, `replace` or `emplace`, which stamp the current
// tick, so that a consumer can ask what was added, changed or removed since it last looked. Iteration order depends
// only on the sequence of calls. Writing is not thread-safe; any number of threads may read between writes.
#pragma once

#include "engine/ecs/view.h"

#include <memory>

namespace sunfleck::ecs {

class Registry {
public:
    Registry();
    Registry(Registry&&) = delete;
    Registry(const Registry&) = delete;
    Registry& operator=(const Registry&) = delete;

    Entity create();
    // Removes all components, then the entity. `entity` must be alive.
    void destroy(Entity entity);
    bool alive(Entity entity) const {
        return entity.index < generations_.size() && generations_[entity.index] == entity.generation &&
               living_[entity.index];
    }
    std::size_t entity_count() const;
    // Unlike that of any other registry of this process, one that was destroyed included.
    std::uint64_t id() const { return id_; }
    // Living entities in order of index.
    std::vector<Entity> entities() const;

    template <typename T>
    const T& emplace(Entity entity, T value = {}) {
        assert(alive(entity) && "emplace on a dead entity");
        assert(iterating_ == 0 && "defer structural changes while iterating");
        Pool<T>& target = pool<T>();
        assert(!target.contains(entity) && "the entity already has this component");
        target.emplace(entity, std::move(value), tick_);
        after_gain(target, entity);
        return target.value(target.position_of(entity.index));
    }
    template <typename T>
    const T& emplace_or_replace(Entity entity, T value) {
        if (!has<T>(entity))
            return emplace<T>(entity, std::move(value));
        patch<T>(entity, [&](T& stored) { stored = std::move(value); });
        return get<T>(entity);
    }
    template <typename T>
    void remove(Entity entity) {
        Pool<T>& target = pool<T>();
        assert(target.contains(entity) && "remove needs the component");
        assert(iterating_ == 0 && "defer structural changes while iterating");
        erase(target, entity);
    }
    template <typename T>
    bool has(Entity entity) const {
        const Pool<T>* source = find_pool<T>();
        return source != nullptr && source->contains(entity);
    }
    template <typename T>
    const T& get(Entity entity) const {
        const Pool<T>* source = find_pool<T>();
        assert(source != nullptr && source->contains(entity) && "get needs the component");
        return source->value(source->position_of(entity.index));
    }
    template <typename T>
    const T* try_get(Entity entity) const {
        return has<T>(entity) ? &get<T>(entity) : nullptr;
    }
    // change(T&) edits in place; the element counts as changed even if its value stays the same.
    template <typename T, typename Change>
    void patch(Entity entity, Change&& change) {
        Pool<T>& target = pool<T>();
        assert(target.contains(entity) && "patch needs the component");
        change(target.value(target.position_of(entity.index)));
        target.stamp(entity, tick_);
        if (!target.changed.empty())
            target.changed.emit(*this, entity);
    }

    // emplace_or_replace that leaves the element and its tick alone if the value is the same; true if it was not.
    template <typename T>
    bool update(Entity entity, T value) {
        if (const T* stored = try_get<T>(entity); stored != nullptr && *stored == value)
            return false;
        emplace_or_replace<T>(entity, std::move(value));
        return true;
    }

    template <typename... Ts>
    View<Ts...> view() {
        return View<Ts...>(*this, find_pool<Ts>()...);
    }
    template <typename T>
    std::size_t count() const {
        const Pool<T>* source = find_pool<T>();
        return source == nullptr ? 0 : source->size();
    }
    // Declares that Ts are often iterated together. Best called early; later calls sort the existing elements.
    template <typename... Ts>
    Group<Ts...> group() {
        const std::vector<PoolBase*> members{&pool<Ts>()...};
        GroupBase* base = find_or_make_group(members);
        return Group<Ts...>(*this, *base, &pool<Ts>()...);
    }

    // --- Changes -------------------------------------------------------------------------------------------------
    Tick tick() const { return tick_; }
    // Ends the current tick and returns it: all later changes count as "since" the returned value.
    Tick advance_tick() { return tick_++; }
    // body(Entity, const T&) for elements stamped after `since`, in pool order. Additions count as changes.
    template <typename T, typename Body>
    void each_changed_since(Tick since, Body&& body) {
        if (const Pool<T>* source = find_pool<T>(); source != nullptr && source->newest_stamp() > since) {
            const IterationScope scope(*this);
            for (std::size_t i = 0; i < source->size(); ++i)
                if (source->changed_tick(i) > since)
                    body(source->entities()[i], source->value(i));
        }
    }
    template <typename T, typename Body>
    void each_added_since(Tick since, Body&& body) {
        if (const Pool<T>* source = find_pool<T>(); source != nullptr && source->newest_stamp() > since) {
            const IterationScope scope(*this);
            for (std::size_t i = 0; i < source->size(); ++i)
                if (source->added_tick(i) > since)
                    body(source->entities()[i], source->value(i));
        }
    }
    // body(Entity) for removals after `since`, oldest first; the entity may be dead. The log is bounded: ask
    // knows_removals_since, and compare with a copy where it says no.
    template <typename T, typename Body>
    void each_removed_since(Tick since, Body&& body) const {
        if (const Pool<T>* source = find_pool<T>(); source != nullptr && source->newest_removal() > since)
            for (const Removal& removal : source->removals())
                if (removal.tick > since)
                    body(removal.entity);
    }
    template <typename T>
    bool knows_removals_since(Tick since) const {
        const Pool<T>* source = find_pool<T>();
        return source == nullptr || source->knows_removals_since(since);
    }
    // At once, without a look at the elements.
    template <typename T>
    bool any_change_since(Tick since) const {
        const Pool<T>* source = find_pool<T>();
        return source != nullptr && std::max(source->newest_stamp(), source->newest_removal()) > since;
    }
    // Another number than before: loops over T may go in another order.
    template <typename T>
    std::uint64_t order_version() const {
        const Pool<T>* source = find_pool<T>();
        return source == nullptr ? 0 : source->order_version();
    }
    // Drops removals that every consumer has seen from the log, before its length makes it drop them.
    void forget_removals_until(Tick tick);

    // --- Signals: added (after), changed (after), removed (before destruction) -- ---------------------------------
    template <typename T>
    Signal& on_added() {
        return pool<T>().added;
    }
    template <typename T>
    Signal& on_changed() {
        return pool<T>().changed;
    }
    template <typename T>
    Signal& on_removed() {
        return pool<T>().removed;
    }

    // Runs `change` now, or, inside a loop, when the outermost loop has ended, in call order.
    void defer(std::function<void(Registry&)> change);

    // --- For snapshots -------------------------------------------------------------------------------------------
    // Creates the pool of T, so that a snapshot that holds T can be restored into an empty registry.
    template <typename T>
    void register_component() {
        pool<T>();
    }
    // All pools of described components, by name.
    std::vector<PoolBase*> described_pools();
    // Adds a default element for `entity` and returns its address; used when restoring.
    void* emplace_default(PoolBase& target, Entity entity);
    void finish_default(PoolBase& target, Entity entity) { after_gain(target, entity); }

    // --- For histories and copies: components without their types ------------------------------------------------
    // Every pool that there is, in an order that depends on the process.
    std::vector<PoolBase*> all_pools();
    // This registry's pool of the same component type; made if there is none.
    PoolBase& counterpart(const PoolBase& other);
    // The component's value; null if the entity lacks it.
    Value value(const PoolBase& source, Entity entity) const;
    // emplace_or_replace, or, for null, remove if it is there. The value must be of the pool's type.
    void set_value(PoolBase& target, Entity entity, const void* value);

    // Keeps handles with a lower index than `until` for create_as: create() hands out others.
    void reserve_handles(std::uint32_t until);
    // Creates just this entity, which must have been reserved and not be alive.
    void create_as(Entity entity);

private:
    friend class IterationScope;

    template <typename T>
    static std::size_t type_index() {
        static const std::size_t index = next_type_index();
        return index;
    }
    static std::size_t next_type_index();

    template <typename T>
    Pool<T>& pool() {
        const std::size_t index = type_index<T>();
        if (index >= pools_.size())
            pools_.resize(index + 1);
        if (!pools_[index]) {
            pools_[index] = std::make_unique<Pool<T>>();
            pools_[index]->type_index = index;
        }
        return static_cast<Pool<T>&>(*pools_[index]);
    }
    template <typename T>
    const Pool<T>* find_pool() const {
        const std::size_t index = type_index<T>();
        return index < pools_.size() ? static_cast<const Pool<T>*>(pools_[index].get()) : nullptr;
    }

    void after_gain(PoolBase& target, Entity entity) {
        if (target.owner != nullptr)
            static_cast<GroupBase*>(target.owner)->entity_gained(entity);
        if (!target.added.empty())
            target.added.emit(*this, entity);
    }
    void erase(PoolBase& target, Entity entity);
    GroupBase* find_or_make_group(const std::vector<PoolBase*>& members);
    void run_deferred();

    std::vector<std::uint32_t> generations_;
    std::vector<std::uint8_t> living_;
    std::vector<std::uint32_t> free_;
    std::uint32_t reserved_until_ = 0;
    std::vector<std::unique_ptr<PoolBase>> pools_;
    std::vector<std::unique_ptr<GroupBase>> groups_;
    std::vector<std::function<void(Registry&)>> deferred_;
    Tick tick_ = 1;
    std::uint64_t id_;
    int iterating_ = 0;
};

inline IterationScope::IterationScope(Registry& registry) : registry_(registry) {
    ++registry_.iterating_;
}
inline IterationScope::~IterationScope() {
    if (--registry_.iterating_ == 0 && !registry_.deferred_.empty())
        registry_.run_deferred();
}

} // namespace sunfleck::ecs

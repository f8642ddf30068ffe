// One dense array per component type, with the ticks of each element's addition and last change.
#pragma once

#include "engine/ecs/entity.h"

#include <algorithm>
#include <cassert>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace sunfleck::ecs {

class Registry;

// A component's value apart from any pool, of the type that its pool knows; null: no such component.
using Value = std::shared_ptr<const void>;

// A component that is computed from others: copies of a world and histories of edits leave it out.
template <typename T>
concept Derived = requires {
    requires T::derived;
};

struct Removal {
    Entity entity;
    Tick tick;
};

// Listeners to one kind of event, called in order of connection. A listener must not add or remove
// components of the pool that calls it; defer such changes.
class Signal {
public:
    using Listener = std::function<void(Registry&, Entity)>;
    std::uint32_t connect(Listener listener) {
        listeners_.push_back({++last_id_, std::move(listener)});
        return last_id_;
    }
    void disconnect(std::uint32_t id) {
        std::erase_if(listeners_, [id](const auto& entry) { return entry.first == id; });
    }
    void emit(Registry& registry, Entity entity) const {
        for (const auto& [id, listener] : listeners_)
            listener(registry, entity);
    }
    bool empty() const { return listeners_.empty(); }

private:
    std::vector<std::pair<std::uint32_t, Listener>> listeners_;
    std::uint32_t last_id_ = 0;
};

// The type-independent part of a pool: the sparse set of entities and change tracking.
class PoolBase {
public:
    static constexpr std::uint32_t absent = 0xffffffffu;
    static constexpr std::size_t removals_kept = 4096; // at least

    virtual ~PoolBase() = default;

    std::size_t size() const { return entities_.size(); }
    const std::vector<Entity>& entities() const { return entities_; }
    bool contains(Entity entity) const {
        const std::uint32_t position = position_of(entity.index);
        return position != absent && entities_[position] == entity;
    }
    // Index in the dense arrays, or `absent`. Does not check the generation.
    std::uint32_t position_of(std::uint32_t index) const { return index < sparse_.size() ? sparse_[index] : absent; }

    Tick added_tick(std::size_t position) const { return added_[position]; }
    Tick changed_tick(std::size_t position) const { return changed_[position]; }
    // When anything was last added, changed or removed; 0: never.
    Tick newest_stamp() const { return newest_stamp_; }
    Tick newest_removal() const { return newest_removal_; }
    // Raised whenever elements come, go or swap places.
    std::uint64_t order_version() const { return order_version_; }

    // The newest removals, oldest first: the log drops old ones when it outgrows the pool, whoever reads it.
    std::span<const Removal> removals() const { return removals_; }
    // Whether the log still has all removals after `since`.
    bool knows_removals_since(Tick since) const { return since >= forgotten_until_; }
    void forget_removals_until(Tick tick) {
        for (const Removal& removal : removals_)
            if (removal.tick <= tick)
                forgotten_until_ = std::max(forgotten_until_, removal.tick);
        std::erase_if(removals_, [tick](const Removal& removal) { return removal.tick <= tick; });
    }

    // For snapshots: null if the component has no description; it is not saved then.
    virtual const TypeDescription* description() const = 0;
    virtual const void* address(std::size_t position) const = 0;
    virtual void* emplace_default(Entity entity, Tick tick) = 0;

    // For histories and copies of a world, which handle components without knowing their types.
    virtual bool is_derived() const = 0;
    // Whether values can be copied; `copy` must not be called otherwise.
    virtual bool is_copyable() const = 0;
    // The element at that position, or any value of the type.
    virtual Value copy(std::size_t position) const = 0;
    virtual std::shared_ptr<void> copy_value(const void* value) const = 0;
    virtual std::shared_ptr<void> default_value() const = 0;
    virtual void assign(std::size_t position, const void* value) = 0;
    virtual std::unique_ptr<PoolBase> make_empty() const = 0;

    void erase(Entity entity, Tick tick) {
        const std::uint32_t position = sparse_[entity.index];
        const std::uint32_t last = std::uint32_t(entities_.size() - 1);
        move_values_last_to(position);
        entities_[position] = entities_[last];
        added_[position] = added_[last];
        changed_[position] = changed_[last];
        sparse_[entities_[position].index] = position;
        sparse_[entity.index] = absent;
        entities_.pop_back();
        added_.pop_back();
        changed_.pop_back();
        removals_.push_back({entity, tick});
        newest_removal_ = tick;
        ++order_version_;
        if (removals_.size() > std::max<std::size_t>(removals_kept, 2 * entities_.size()))
            forget_removals_until(removals_[removals_.size() / 2].tick);
    }

    void swap_positions(std::uint32_t a, std::uint32_t b) {
        if (a == b)
            return;
        ++order_version_;
        swap_values(a, b);
        std::swap(entities_[a], entities_[b]);
        std::swap(added_[a], added_[b]);
        std::swap(changed_[a], changed_[b]);
        sparse_[entities_[a].index] = a;
        sparse_[entities_[b].index] = b;
    }

    void stamp(Entity entity, Tick tick) {
        changed_[sparse_[entity.index]] = tick;
        newest_stamp_ = tick;
    }

    Signal added, changed, removed;
    // Set by the group that owns this pool's order.
    void* owner = nullptr;
    // Of the component type, the same in all registries of the process; set by the registry.
    std::size_t type_index = 0;

protected:
    void insert(Entity entity, Tick tick) {
        if (entity.index >= sparse_.size())
            sparse_.resize(std::max<std::size_t>(entity.index + 1, sparse_.size() * 2), absent);
        sparse_[entity.index] = std::uint32_t(entities_.size());
        entities_.push_back(entity);
        added_.push_back(tick);
        changed_.push_back(tick);
        newest_stamp_ = tick;
        ++order_version_;
    }
    virtual void move_values_last_to(std::uint32_t position) = 0;
    virtual void swap_values(std::uint32_t a, std::uint32_t b) = 0;

private:
    std::vector<std::uint32_t> sparse_;
    std::vector<Entity> entities_;
    std::vector<Tick> added_;
    std::vector<Tick> changed_;
    std::vector<Removal> removals_;
    Tick newest_stamp_ = 0, newest_removal_ = 0, forgotten_until_ = 0;
    std::uint64_t order_version_ = 0;
};

template <typename T>
class Pool final : public PoolBase {
public:
    T& emplace(Entity entity, T value, Tick tick) {
        insert(entity, tick);
        values_.push_back(std::move(value));
        return values_.back();
    }
    T& value(std::size_t position) { return values_[position]; }
    const T& value(std::size_t position) const { return values_[position]; }
    T* data() { return values_.data(); }
    const T* data() const { return values_.data(); }

    const TypeDescription* description() const override {
        if constexpr (Described<T>)
            return &T::description();
        else
            return nullptr;
    }
    const void* address(std::size_t position) const override { return &values_[position]; }
    void* emplace_default(Entity entity, Tick tick) override { return &emplace(entity, T{}, tick); }
    bool is_derived() const override { return Derived<T>; }
    bool is_copyable() const override { return std::is_copy_constructible_v<T> && std::is_copy_assignable_v<T>; }
    Value copy(std::size_t position) const override { return copy_value(&values_[position]); }
    std::shared_ptr<void> copy_value(const void* value) const override {
        if constexpr (std::is_copy_constructible_v<T>)
            return std::make_shared<T>(*static_cast<const T*>(value));
        else
            return nullptr;
    }
    std::shared_ptr<void> default_value() const override { return std::make_shared<T>(); }
    void assign(std::size_t position, const void* value) override {
        if constexpr (std::is_copy_assignable_v<T>)
            values_[position] = *static_cast<const T*>(value);
    }
    std::unique_ptr<PoolBase> make_empty() const override { return std::make_unique<Pool<T>>(); }

private:
    void move_values_last_to(std::uint32_t position) override {
        if (position + 1 != values_.size())
            values_[position] = std::move(values_.back());
        values_.pop_back();
    }
    void swap_values(std::uint32_t a, std::uint32_t b) override { std::swap(values_[a], values_[b]); }

    std::vector<T> values_;
};

} // namespace sunfleck::ecs

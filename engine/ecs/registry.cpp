#include "engine/ecs/registry.h"

#include <algorithm>
#include <atomic>

namespace sunfleck::ecs {

Registry::Registry() {
    static std::atomic<std::uint64_t> made{0};
    id_ = ++made;
}

std::size_t Registry::next_type_index() {
    static std::atomic<std::size_t> next{0};
    return next++;
}

Entity Registry::create() {
    if (free_.empty()) {
        generations_.push_back(0);
        living_.push_back(1);
        return {std::uint32_t(generations_.size() - 1), 0};
    }
    const std::uint32_t index = free_.back();
    free_.pop_back();
    living_[index] = 1;
    return {index, generations_[index]};
}

void Registry::destroy(Entity entity) {
    assert(alive(entity) && "destroy needs a living entity");
    assert(iterating_ == 0 && "defer structural changes while iterating");
    for (const auto& target : pools_)
        if (target && target->contains(entity))
            erase(*target, entity);
    ++generations_[entity.index];
    living_[entity.index] = 0;
    if (entity.index >= reserved_until_)
        free_.push_back(entity.index);
}

std::size_t Registry::entity_count() const {
    const auto reserved = living_.begin() + std::ptrdiff_t(reserved_until_);
    return generations_.size() - free_.size() - std::size_t(std::count(living_.begin(), reserved, std::uint8_t(0)));
}

std::vector<Entity> Registry::entities() const {
    std::vector<Entity> result;
    result.reserve(entity_count());
    for (std::uint32_t index = 0; index < generations_.size(); ++index)
        if (living_[index])
            result.push_back({index, generations_[index]});
    return result;
}

void Registry::erase(PoolBase& target, Entity entity) {
    if (!target.removed.empty())
        target.removed.emit(*this, entity);
    if (target.owner != nullptr)
        static_cast<GroupBase*>(target.owner)->entity_losing(entity);
    target.erase(entity, tick_);
}

void Registry::forget_removals_until(Tick tick) {
    for (const auto& target : pools_)
        if (target)
            target->forget_removals_until(tick);
}

void Registry::defer(std::function<void(Registry&)> change) {
    if (iterating_ == 0)
        change(*this);
    else
        deferred_.push_back(std::move(change));
}

void Registry::run_deferred() {
    // A deferred change may itself loop and defer more: those run when its loop ends, before the rest of this list.
    const std::vector<std::function<void(Registry&)>> changes = std::exchange(deferred_, {});
    for (const auto& change : changes)
        change(*this);
}

GroupBase* Registry::find_or_make_group(const std::vector<PoolBase*>& members) {
    for (const auto& group : groups_)
        if (group->pools() == members)
            return group.get();
    groups_.push_back(std::make_unique<GroupBase>(members));
    return groups_.back().get();
}

std::vector<PoolBase*> Registry::described_pools() {
    std::vector<PoolBase*> result;
    for (const auto& target : pools_)
        if (target && target->description() != nullptr)
            result.push_back(target.get());
    std::sort(result.begin(), result.end(),
              [](const PoolBase* a, const PoolBase* b) { return a->description()->name < b->description()->name; });
    return result;
}

std::vector<PoolBase*> Registry::all_pools() {
    std::vector<PoolBase*> result;
    for (const auto& target : pools_)
        if (target)
            result.push_back(target.get());
    return result;
}

PoolBase& Registry::counterpart(const PoolBase& other) {
    if (other.type_index >= pools_.size())
        pools_.resize(other.type_index + 1);
    std::unique_ptr<PoolBase>& own = pools_[other.type_index];
    if (!own) {
        own = other.make_empty();
        own->type_index = other.type_index;
    }
    return *own;
}

Value Registry::value(const PoolBase& source, Entity entity) const {
    return source.contains(entity) ? source.copy(source.position_of(entity.index)) : Value();
}

void Registry::set_value(PoolBase& target, Entity entity, const void* value) {
    assert(alive(entity) && target.is_copyable());
    const bool has = target.contains(entity);
    if (value == nullptr) {
        assert(iterating_ == 0 && "defer structural changes while iterating");
        if (has)
            erase(target, entity);
        return;
    }
    if (!has) {
        assert(iterating_ == 0 && "defer structural changes while iterating");
        target.emplace_default(entity, tick_);
        target.assign(target.position_of(entity.index), value);
        after_gain(target, entity);
        return;
    }
    target.assign(target.position_of(entity.index), value);
    target.stamp(entity, tick_);
    if (!target.changed.empty())
        target.changed.emit(*this, entity);
}

void Registry::reserve_handles(std::uint32_t until) {
    while (generations_.size() < until) {
        generations_.push_back(0);
        living_.push_back(0);
    }
    std::erase_if(free_, [until](std::uint32_t index) { return index < until; });
    reserved_until_ = std::max(reserved_until_, until);
}

void Registry::create_as(Entity entity) {
    assert(entity.index < reserved_until_ && !living_[entity.index]);
    generations_[entity.index] = entity.generation;
    living_[entity.index] = 1;
}

void* Registry::emplace_default(PoolBase& target, Entity entity) {
    assert(alive(entity) && !target.contains(entity));
    return target.emplace_default(entity, tick_);
}

} // namespace sunfleck::ecs

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
    free_.push_back(entity.index);
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

void* Registry::emplace_default(PoolBase& target, Entity entity) {
    assert(alive(entity) && !target.contains(entity));
    return target.emplace_default(entity, tick_);
}

} // namespace sunfleck::ecs

#include "engine/ecs/world_copy.h"

namespace sunfleck::ecs {
namespace {

void copy_entities(const Registry& from, Registry& to) {
    for (const Entity entity : to.entities())
        if (!from.alive(entity))
            to.destroy(entity);
    const std::vector<Entity> entities = from.entities();
    if (!entities.empty())
        to.reserve_handles(entities.back().index + 1);
    for (const Entity entity : entities)
        if (!to.alive(entity))
            to.create_as(entity);
}

// Components that only `to` has.
void remove_others(Registry& from, Registry& to) {
    for (PoolBase* pool : to.all_pools()) {
        if (!pool->is_copyable())
            continue;
        const PoolBase& source = from.counterpart(*pool);
        std::vector<Entity> others;
        for (const Entity entity : pool->entities())
            if (!source.contains(entity))
                others.push_back(entity);
        for (const Entity entity : others)
            to.set_value(*pool, entity, nullptr);
    }
}

} // namespace

void copy_world(Registry& from, Registry& to) {
    copy_entities(from, to);
    remove_others(from, to);
    for (const PoolBase* pool : from.all_pools()) {
        if (!pool->is_copyable())
            continue;
        PoolBase& target = to.counterpart(*pool);
        for (std::size_t i = 0; i < pool->size(); ++i)
            to.set_value(target, pool->entities()[i], pool->address(i));
    }
}

} // namespace sunfleck::ecs

#include "engine/ecs/registry.h"
#include "engine/ecs/snapshot.h"
#include "engine/ecs/world_copy.h"
#include "engine/scene/components.h"

#include "engine/core/random.h"

#include <gtest/gtest.h>

#include <map>

namespace sunfleck::ecs {
namespace {

struct Position {
    float x = 0;
};
struct Velocity {
    float x = 0;
};
struct Tag {};

TEST(Registry, ReusedSlotsHaveANewGeneration) {
    Registry registry;
    const Entity a = registry.create();
    registry.emplace<Position>(a, {1});
    registry.destroy(a);
    const Entity b = registry.create();
    EXPECT_EQ(a.index, b.index);
    EXPECT_NE(a, b);
    EXPECT_FALSE(registry.alive(a));
    EXPECT_TRUE(registry.alive(b));
    EXPECT_FALSE(registry.has<Position>(a));
    EXPECT_FALSE(registry.has<Position>(b));
    EXPECT_EQ(registry.try_get<Position>(b), nullptr);
}

TEST(RegistryDeathTest, MisuseAsserts) {
    Registry registry;
    const Entity entity = registry.create();
    EXPECT_DEATH((void)registry.get<Position>(entity), "needs the component");
    registry.emplace<Position>(entity);
    EXPECT_DEATH(registry.emplace<Position>(entity), "already");
    EXPECT_DEATH(registry.view<Position>().each([&](Entity e, const Position&) { registry.remove<Position>(e); }),
                 "defer");
    registry.destroy(entity);
    EXPECT_DEATH(registry.destroy(entity), "living");
}

// A registry driven at random beside plain maps must agree with them after every step.
TEST(Registry, AgreesWithAModelUnderRandomChanges) {
    for (const bool grouped : {false, true}) {
        Registry registry;
        if (grouped)
            registry.group<Position, Velocity>();
        std::vector<Entity> alive;
        std::map<std::uint32_t, float> positions, velocities;
        RandomSequence random(SequenceKind::pseudo_random, 5, 0);
        for (int step = 0; step < 5000; ++step) {
            const float action = random.next();
            const Entity entity = alive.empty() ? null_entity : alive[std::size_t(random.next() * float(alive.size()))];
            if (alive.empty() || action < 0.3f) {
                alive.push_back(registry.create());
            } else if (action < 0.4f) {
                registry.destroy(entity);
                positions.erase(entity.index);
                velocities.erase(entity.index);
                std::erase(alive, entity);
            } else if (action < 0.7f) {
                registry.emplace_or_replace<Position>(entity, {float(step)});
                positions[entity.index] = float(step);
            } else if (action < 0.85f) {
                registry.emplace_or_replace<Velocity>(entity, {float(step)});
                velocities[entity.index] = float(step);
            } else if (registry.has<Position>(entity)) {
                registry.remove<Position>(entity);
                positions.erase(entity.index);
            }
            if (step % 50 != 0)
                continue;
            std::map<std::uint32_t, float> seen, expected;
            const auto check = [&](Entity e, const Position& p, const Velocity& v) {
                EXPECT_EQ(p.x, positions.at(e.index));
                EXPECT_EQ(v.x, velocities.at(e.index));
                EXPECT_TRUE(seen.emplace(e.index, p.x).second);
            };
            if (grouped)
                registry.group<Position, Velocity>().each(check);
            else
                registry.view<Position, Velocity>().each(check);
            for (const auto& [index, x] : positions)
                if (velocities.count(index))
                    expected[index] = x;
            ASSERT_EQ(seen, expected);
            ASSERT_EQ(registry.entity_count(), alive.size());
        }
    }
}

TEST(Registry, TicksTellAddedChangedAndRemoved) {
    Registry registry;
    const Entity a = registry.create(), b = registry.create();
    registry.emplace<Position>(a);
    registry.emplace<Position>(b);
    const Tick seen = registry.advance_tick();
    EXPECT_FALSE(registry.any_change_since<Position>(seen));
    registry.patch<Position>(a, [](Position& p) { p.x = 2; });
    const Entity c = registry.create();
    registry.emplace<Position>(c);
    registry.remove<Position>(b);
    std::vector<Entity> changed, added, removed;
    registry.each_changed_since<Position>(seen, [&](Entity e, const Position&) { changed.push_back(e); });
    registry.each_added_since<Position>(seen, [&](Entity e, const Position&) { added.push_back(e); });
    registry.each_removed_since<Position>(seen, [&](Entity e) { removed.push_back(e); });
    EXPECT_EQ(changed, (std::vector<Entity>{a, c}));
    EXPECT_EQ(added, std::vector<Entity>{c});
    EXPECT_EQ(removed, std::vector<Entity>{b});
    const Tick later = registry.advance_tick();
    EXPECT_FALSE(registry.any_change_since<Position>(later));
    registry.forget_removals_until(later);
    removed.clear();
    registry.each_removed_since<Position>(seen, [&](Entity e) { removed.push_back(e); });
    EXPECT_TRUE(removed.empty());
}

TEST(Registry, SignalsFireInOrderAndCanBeDisconnected) {
    Registry registry;
    std::string log;
    registry.on_added<Position>().connect([&](Registry&, Entity) { log += "a"; });
    const std::uint32_t second = registry.on_added<Position>().connect([&](Registry&, Entity) { log += "b"; });
    registry.on_changed<Position>().connect([&](Registry&, Entity) { log += "c"; });
    registry.on_removed<Position>().connect([&](Registry& r, Entity e) { log += r.has<Position>(e) ? "r" : "!"; });
    const Entity entity = registry.create();
    registry.emplace<Position>(entity);
    registry.patch<Position>(entity, [](Position&) {});
    registry.on_added<Position>().disconnect(second);
    registry.destroy(entity);
    registry.emplace<Position>(registry.create());
    EXPECT_EQ(log, "abcra");
}

TEST(Registry, DeferredChangesRunAfterTheOutermostLoop) {
    Registry registry;
    for (int i = 0; i < 10; ++i)
        registry.emplace<Position>(registry.create(), {float(i)});
    int visited = 0;
    registry.view<Position>().each([&](Entity entity, const Position& p) {
        ++visited;
        registry.view<Position>().each([&](Entity, const Position&) {});
        if (int(p.x) % 2 == 0)
            registry.defer([entity](Registry& r) { r.destroy(entity); });
        registry.defer([](Registry& r) { r.emplace<Tag>(r.create()); });
    });
    EXPECT_EQ(visited, 10);
    EXPECT_EQ(registry.count<Position>(), 5u);
    EXPECT_EQ(registry.count<Tag>(), 10u);
}

TEST(Snapshot, RestoresValuesAndMapsEntities) {
    Registry source;
    scene::register_components(source);
    const Entity spare = source.create(); // shifts the indices
    const Entity parent = source.create(), child = source.create();
    source.emplace<scene::Name>(parent, {"parent"});
    source.emplace<scene::Transform>(child, {vec3(1, 2, 3), quat(0.5f, 0.5f, 0.5f, 0.5f), vec3(2)});
    source.emplace<scene::Parent>(child, {parent});
    source.emplace<scene::Mover>(child, {scene::MoverPath::circle});
    source.destroy(spare);
    const std::string bytes = save_snapshot(source);

    Registry target;
    scene::register_components(target);
    target.create(); // other handles than in the source
    target.create();
    target.create();
    const auto map = restore_snapshot(target, bytes);
    ASSERT_TRUE(map) << map.error().message;
    const Entity new_child = map->at(child.bits()), new_parent = map->at(parent.bits());
    EXPECT_NE(new_child, child);
    EXPECT_EQ(target.get<scene::Parent>(new_child).parent, new_parent);
    EXPECT_EQ(target.get<scene::Name>(new_parent).name, "parent");
    EXPECT_EQ(target.get<scene::Transform>(new_child).position, vec3(1, 2, 3));
    EXPECT_EQ(target.get<scene::Mover>(new_child).path, scene::MoverPath::circle);
}

// Into an empty registry, and over one that went its own way since.
TEST(WorldCopy, HasTheSameEntitiesAndComponents) {
    RandomSequence random(SequenceKind::pseudo_random, 11, 0);
    Registry from, to;
    std::vector<Entity> alive;
    const auto change = [&](Registry& registry, std::vector<Entity>& living) {
        for (int i = 0; i < 200; ++i) {
            const float action = random.next();
            if (action < 0.4f || living.empty()) {
                living.push_back(registry.create());
                registry.emplace<Position>(living.back(), {random.next()});
                continue;
            }
            const std::size_t place = std::size_t(random.next() * float(living.size()));
            const Entity entity = living[place];
            if (action < 0.55f) {
                registry.destroy(entity);
                living.erase(living.begin() + std::ptrdiff_t(place));
            } else if (action < 0.8f) {
                registry.emplace_or_replace<Velocity>(entity, {random.next()});
            } else if (registry.has<Velocity>(entity)) {
                registry.remove<Velocity>(entity);
            }
        }
    };
    const auto expect_same = [&] {
        EXPECT_EQ(from.entities(), to.entities());
        EXPECT_EQ(from.count<Position>(), to.count<Position>());
        EXPECT_EQ(from.count<Velocity>(), to.count<Velocity>());
        for (const Entity entity : from.entities()) {
            ASSERT_EQ(from.has<Position>(entity), to.has<Position>(entity));
            ASSERT_EQ(from.has<Velocity>(entity), to.has<Velocity>(entity));
            if (from.has<Position>(entity)) {
                EXPECT_EQ(from.get<Position>(entity).x, to.get<Position>(entity).x);
            }
            if (from.has<Velocity>(entity)) {
                EXPECT_EQ(from.get<Velocity>(entity).x, to.get<Velocity>(entity).x);
            }
        }
    };
    change(from, alive);
    copy_world(from, to);
    expect_same();
    std::vector<Entity> order_from, order_to;
    from.view<Position>().each([&](Entity entity, const Position&) { order_from.push_back(entity); });
    to.view<Position>().each([&](Entity entity, const Position&) { order_to.push_back(entity); });
    EXPECT_EQ(order_from, order_to);
    for (int round = 0; round < 5; ++round) {
        std::vector<Entity> others = to.entities();
        change(from, alive);
        change(to, others);
        copy_world(from, to);
        expect_same();
    }
}

TEST(Snapshot, DamageIsAnErrorAndChangesNothing) {
    Registry source;
    scene::register_components(source);
    source.emplace<scene::Name>(source.create(), {"x"});
    const std::string bytes = save_snapshot(source);
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        std::string damaged = bytes;
        damaged[i] = char(damaged[i] ^ 0x40);
        Registry target;
        scene::register_components(target);
        ASSERT_FALSE(restore_snapshot(target, damaged)) << "byte " << i;
        ASSERT_EQ(target.entity_count(), 0u);
        ASSERT_FALSE(restore_snapshot(target, bytes.substr(0, i)));
    }
    Registry without; // does not know the component
    EXPECT_FALSE(restore_snapshot(without, bytes));
    EXPECT_EQ(without.entity_count(), 0u);
}

} // namespace
} // namespace sunfleck::ecs

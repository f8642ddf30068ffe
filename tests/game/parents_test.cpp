// What moves below a parent: it is judged, and put, where it is in the world.
#include "tests/game/small_level.h"

namespace sunfleck::demo {
namespace {

using tests::SmallLevel;

// A group that is moved and turned by a quarter about the vertical, and things below it.
struct LevelWithGroup : SmallLevel {
    LevelWithGroup() {
        above = group("above", {2.0f, 0.0f, -1.0f});
        registry.patch<scene::Transform>(above, [](scene::Transform& t) {
            t.rotation = glm::angleAxis(0.5f * pi, vec3(0.0f, 1.0f, 0.0f)); // maps +Z to +X, +X to -Z
            t.scale = vec3(2.0f);
        });
    }
    ecs::Entity above;
};

TEST(GameParents, ADoorOpensToWhoComesNearItAndNotNearItsPlaceInTheGroup) {
    LevelWithGroup level;
    const ecs::Entity door = level.box("door", {0.0f, 0.5f, 1.5f}, {0.4f, 1.0f, 0.1f}); // at 5, 1, -1
    scene::Mover mover;
    mover.path = scene::MoverPath::line;
    mover.activation = scene::MoverActivation::near;
    level.registry.emplace<scene::Mover>(door, mover);
    level.put_under(door, level.above);
    level.begin();
    const auto open = [&] { return level.registry.get<scene::MoverState>(door).open; };
    level.stand_at({0.0f, 0.0f, 2.5f});
    level.run(3);
    EXPECT_FALSE(open());
    level.stand_at({3.8f, 0.0f, -1.0f});
    level.run(3);
    EXPECT_TRUE(open());
}

TEST(GameParents, ABodyFallsWhereItIs) {
    LevelWithGroup level;
    const ecs::Entity crate = level.box("crate", {0.0f, 0.8f, 1.0f}, {0.25f, 0.25f, 0.25f}); // at 4, 1.6, -1
    level.registry.emplace<scene::Mover>(crate, {});
    level.registry.emplace<scene::RigidBody>(crate, {});
    level.put_under(crate, level.above);
    level.begin();
    level.run(120);
    EXPECT_NEAR(level.at(crate).x, 4.0f, 0.05f);
    EXPECT_NEAR(level.at(crate).y, 0.25f, 0.03f) << "on the floor";
    EXPECT_NEAR(level.at(crate).z, -1.0f, 0.05f);
    // A place is relative to the group, too.
    scene::Transform there = level.registry.get<scene::Transform>(crate);
    there.position = vec3(0.0f, 0.5f, 0.5f);
    level.world->simulation().physics().place(level.registry, crate, there);
    level.run(60);
    EXPECT_NEAR(level.at(crate).x, 3.0f, 0.05f);
    EXPECT_NEAR(level.at(crate).y, 0.25f, 0.03f);
}

TEST(GameParents, ALanternIsCarriedAndPutDownWhereThePersonIs) {
    LevelWithGroup level;
    const ecs::Entity lantern = level.lantern("lantern", {0.0f, 0.0f, 0.5f}); // at 3, 0, -1
    level.put_under(lantern, level.above);
    level.begin();
    level.take(lantern);
    ASSERT_TRUE(level.world->simulation().carries_lantern());
    level.stand_at({-3.0f, 0.0f, 0.0f});
    level.run(10);
    EXPECT_LT(glm::length(level.at(lantern) - level.person().eye()), 1.2f);
    level.press(simulation::button_put_down);
    EXPECT_NEAR(level.at(lantern).x, -3.0f, 0.05f);
    EXPECT_NEAR(level.at(lantern).y, 0.0f, 0.02f);
    EXPECT_NEAR(level.at(lantern).z, -0.7f, 0.05f);
}

// The room is the box that holds it in the world.
TEST(GameParents, AResetPutsBackWhatBeganInTheRoom) {
    LevelWithGroup level;
    const ecs::Entity crate = level.box("crate", {0.0f, 0.2f, 1.0f}, {0.2f, 0.2f, 0.2f}); // at 4, 0.4, -1
    level.registry.emplace<scene::Mover>(crate, {});
    level.registry.emplace<scene::RigidBody>(crate, {});
    level.put_under(crate, level.above);
    scene::GameArea described;
    described.half_size = vec3(2.5f, 2.0f, 6.0f);
    described.entry = vec3(0.0f, -1.0f, 3.0f);
    level.area("area", {3.5f, 1.0f, 0.0f}, described);
    level.begin();
    const vec3 began = level.at(crate);
    level.stand_at({3.0f, 0.0f, 4.0f});
    level.run(5);
    scene::Transform away = level.registry.get<scene::Transform>(crate);
    away.position = vec3(1.0f, 0.2f, 0.0f);
    level.world->simulation().physics().place(level.registry, crate, away);
    level.run(60);
    ASSERT_GT(glm::length(level.at(crate) - began), 1.0f);
    level.press(simulation::button_reset);
    level.run(60);
    EXPECT_NEAR(glm::length(level.at(crate) - began), 0.2f, 0.1f) << "it has fallen to the floor there";
}

} // namespace
} // namespace sunfleck::demo

// Lanterns of levels that people make: taken, carried, put down.
#include "game_demo/game/saved_game.h"
#include "tests/game/small_level.h"

namespace sunfleck::demo {
namespace {

using tests::SmallLevel;

// Its shape is below it, and no obstacle to who carries it.
TEST(GameLantern, OneWithAShapeBelowItIsCarried) {
    SmallLevel level;
    const ecs::Entity lantern = level.lantern("lantern", {0.0f, 0.0f, 2.0f});
    level.begin();
    level.take(lantern);
    ASSERT_TRUE(level.world->simulation().carries_lantern());
    level.look_at({0.0f, 1.5f, -5.0f});
    simulation::StepInput ahead;
    ahead.forward = 100;
    const vec3 before = level.foot();
    level.run(60, ahead);
    EXPECT_NEAR(level.foot().y, 0.0f, 0.03f);
    EXPECT_NEAR(before.z - level.foot().z, 2.2f, 0.3f) << "a second at 2.4 m/s";
    EXPECT_NEAR(level.foot().x, before.x, 0.05f);
    EXPECT_LT(glm::length(level.at(lantern) - level.person().eye()), 1.2f);
    level.press(simulation::button_put_down);
    EXPECT_FALSE(level.world->simulation().carries_lantern());
    EXPECT_NEAR(level.at(lantern).y, 0.0f, 0.01f);
    // Nor to who walks over it.
    const vec3 there = level.foot();
    level.run(60, ahead);
    EXPECT_NEAR(there.z - level.foot().z, 2.3f, 0.3f);
    EXPECT_NEAR(level.foot().y, 0.0f, 0.03f);
}

// A lift, and a block that is pushed, with a lantern put down on them.
struct LevelThatMoves : SmallLevel {
    LevelThatMoves() {
        lift = box("lift", {-3.0f, 1.0f, 0.0f}, {2.0f, 0.1f, 2.0f});
        scene::Mover mover;
        mover.path = scene::MoverPath::line;
        mover.travel = vec3(0.0f, 0.9f, 0.0f);
        mover.phase = -0.25f; // it begins at its lowest
        registry.emplace<scene::Mover>(lift, mover);
        block = box("block", {3.0f, 0.25f, 0.0f}, {0.5f, 0.5f, 0.5f});
        registry.emplace<scene::Mover>(block, {});
        registry.emplace<scene::RigidBody>(block, {});
        hand_lamp = lantern("lantern", {0.0f, 0.0f, 2.0f});
    }
    void put_down_at(vec3 foot) {
        world->simulation().hand_lantern(registry, hand_lamp);
        stand_at(foot);
        run(1);
        press(simulation::button_put_down);
        ASSERT_FALSE(world->simulation().carries_lantern());
    }
    ecs::Entity lift, block, hand_lamp;
};

TEST(GameLantern, RidesTheLiftThatItWasPutDownOn) {
    LevelThatMoves level;
    level.begin();
    level.put_down_at({-3.0f, 0.16f, 0.7f});
    const float above = level.at(level.hand_lamp).y - level.at(level.lift).y, low = level.at(level.lift).y;
    ASSERT_NEAR(above, 0.05f, 0.02f) << "it stands on the lift";
    LevelThatMoves loaded;
    loaded.begin();
    float highest = 0.0f;
    for (int i = 0; i < 480; ++i) {
        level.run(1);
        highest = std::max(highest, level.at(level.lift).y);
        ASSERT_NEAR(level.at(level.hand_lamp).y - level.at(level.lift).y, above, 1e-3f) << i;
        if (i == 100) {
            const Status status = load_game(*loaded.world, "level", save_game(*level.world, "level"));
            ASSERT_TRUE(status) << status.error().message;
        } else if (i > 100) {
            loaded.run(1);
            ASSERT_EQ(loaded.at(loaded.hand_lamp), level.at(level.hand_lamp)) << i;
        }
    }
    EXPECT_GT(highest, low + 1.5f);
}

TEST(GameLantern, StaysOnABlockThatIsPushed) {
    LevelThatMoves level;
    level.begin();
    level.run(30);
    level.put_down_at({3.0f, 0.0f, 0.75f});
    const vec3 from = level.at(level.block), on_it = level.at(level.hand_lamp) - from;
    ASSERT_NEAR(on_it.y, 0.25f, 0.03f) << "it stands on the block";
    simulation::StepInput ahead;
    ahead.forward = 60;
    level.run(240, ahead);
    level.run(60);
    const vec3 way = level.at(level.block) - from;
    ASSERT_GT(glm::length(way), 0.3f);
    EXPECT_NEAR(glm::length(level.at(level.hand_lamp) - level.at(level.block) - on_it), 0.0f, 0.1f);
}

// Where a level begins with it there.
TEST(GameLantern, RidesTheLiftThatItBeginsOn) {
    LevelThatMoves level;
    const ecs::Entity other = level.lantern("other", {-3.0f, 1.05f, 0.0f});
    level.registry.patch<scene::Mover>(level.lift, [](scene::Mover& mover) { mover.phase = 0.0f; });
    level.begin();
    level.run(120);
    EXPECT_GT(level.at(other).y, 1.5f);
    EXPECT_NEAR(level.at(other).y - level.at(level.lift).y, 0.05f, 1e-3f);
}

// What the centre of the view is on is used, and a lantern beside it is not taken.
TEST(GameLantern, IsTakenWhereItIsLookedAtAndNotBesideWhatIsUsed) {
    SmallLevel level;
    const ecs::Entity lantern = level.lantern("lantern", {0.35f, 0.9f, 0.0f});
    const ecs::Entity panel = level.box("panel", {0.0f, 1.0f, -0.5f}, {2.0f, 2.0f, 0.1f});
    scene::Mover mover;
    mover.path = scene::MoverPath::line;
    mover.activation = scene::MoverActivation::use;
    level.registry.emplace<scene::Mover>(panel, mover);
    level.begin();
    level.stand_at({0.0f, 0.0f, 1.2f});
    const auto offered = [&] { return level.world->simulation().possible_interaction(level.registry); };
    level.look_at({-0.1f, 1.2f, -0.45f});
    EXPECT_EQ(offered(), simulation::Interaction::open);
    level.look_at(level.at(lantern));
    EXPECT_EQ(offered(), simulation::Interaction::take);
    level.look_at(level.at(lantern) + vec3(0.0f, 0.3f, 0.0f));
    EXPECT_EQ(offered(), simulation::Interaction::take) << "its top";
    level.look_at(level.at(lantern) + vec3(0.0f, 0.15f, 0.0f));
    level.press(simulation::button_use);
    EXPECT_TRUE(level.world->simulation().carries_lantern());
    EXPECT_FALSE(level.registry.get<scene::MoverState>(panel).open);
}

} // namespace
} // namespace sunfleck::demo

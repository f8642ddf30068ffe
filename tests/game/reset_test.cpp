// Resets of a room, in levels that people make.
#include "game_demo/game/saved_game.h"
#include "tests/game/small_level.h"

namespace sunfleck::demo {
namespace {

using tests::SmallLevel;

// Two rooms, the halves of the floor; three lanterns begin in the southern one.
struct TwoRooms : SmallLevel {
    TwoRooms() {
        scene::GameArea described;
        described.half_size = vec3(half, 2.0f, 0.5f * half);
        described.entry = vec3(0.0f, -1.0f, 0.0f);
        south = area("south", {0.0f, 1.0f, 3.0f}, described);
        north = area("north", {0.0f, 1.0f, -3.0f}, described);
        for (int i = 0; i < 3; ++i)
            lanterns.push_back(lantern("lantern " + std::to_string(i), {2.0f * float(i) - 2.0f, 0.0f, 2.0f}));
        begin();
    }
    ecs::Entity carried() const { return world->simulation().state().carried; }
    // Takes one, carries it to the north and puts it down there.
    void carry_north(ecs::Entity lantern) {
        take(lantern);
        stand_at({0.0f, 0.0f, -2.0f});
        run(10);
        press(simulation::button_put_down);
    }
    ecs::Entity south, north;
    std::vector<ecs::Entity> lanterns;
};

TEST(GameReset, HandsOverTheLanternThatWasCarriedLast) {
    TwoRooms level;
    std::vector<vec3> starts;
    for (const ecs::Entity lantern : level.lanterns)
        starts.push_back(level.at(lantern));
    level.carry_north(level.lanterns[2]);
    level.carry_north(level.lanterns[1]);
    const vec3 laid = level.at(level.lanterns[2]);
    ASSERT_EQ(level.world->area_entity(), level.north);
    level.press(simulation::button_reset);
    EXPECT_EQ(level.carried(), level.lanterns[1]);
    EXPECT_EQ(level.at(level.lanterns[0]), starts[0]) << "nobody has taken it";
    EXPECT_EQ(level.at(level.lanterns[2]), laid);
    // Where they began they are put back.
    level.stand_at({0.0f, 0.0f, 4.0f});
    level.run(2);
    ASSERT_EQ(level.world->area_entity(), level.south);
    level.press(simulation::button_reset);
    EXPECT_TRUE(level.carried().is_null());
    for (std::size_t i = 0; i < 3; ++i)
        EXPECT_EQ(level.at(level.lanterns[i]), starts[i]) << i;
}

TEST(GameReset, HandsOverNoneBeforeOneWasCarried) {
    TwoRooms level;
    level.stand_at({0.0f, 0.0f, -2.0f});
    level.run(2);
    level.press(simulation::button_reset);
    EXPECT_TRUE(level.carried().is_null());
}

TEST(GameReset, ACheckpointKnowsWhichLanternWasCarriedLast) {
    TwoRooms level, other;
    level.carry_north(level.lanterns[1]);
    ASSERT_TRUE(level.carried().is_null());
    const Status loaded = load_game(*other.world, "level", save_game(*level.world, "level"));
    ASSERT_TRUE(loaded) << loaded.error().message;
    other.press(simulation::button_reset);
    EXPECT_EQ(other.carried(), other.lanterns[1]);
}

// As Add > Game area makes it, in mid-air; its entry lies below the floor then.
void expect_that_a_reset_leads_to(vec3 area_at, vec3 entry, vec3 expected, const std::string& what) {
    SmallLevel level;
    level.box("pillar", {2.0f, 1.5f, 0.0f}, {1.0f, 3.0f, 1.0f});
    scene::GameArea described;
    described.half_size = vec3(3.0f, 1.5f, 3.0f);
    described.entry = entry;
    level.area("area", area_at, described);
    level.begin();
    level.stand_at({0.5f, 0.0f, 0.5f});
    level.run(2);
    ASSERT_NE(level.world->area(), nullptr) << what;
    level.press(simulation::button_reset);
    level.run(120);
    EXPECT_NEAR(glm::length(level.foot() - expected), 0.0f, 0.05f)
        << what << ": " << level.foot().x << " " << level.foot().y << " " << level.foot().z;
    EXPECT_TRUE(level.person().grounded()) << what;
    EXPECT_EQ(level.person().rescued(), 0u) << what;
}

TEST(GameReset, ThePersonStandsOnTheFloor) {
    const vec3 air(0.0f, 1.0f, 0.0f);
    expect_that_a_reset_leads_to(air, {1.0f, -1.0f, -2.0f}, {1.0f, 0.0f, -2.0f}, "an entry on the floor");
    expect_that_a_reset_leads_to(air, {1.0f, 1.0f, -2.0f}, {1.0f, 0.0f, -2.0f}, "above it");
    expect_that_a_reset_leads_to(air, {1.0f, -1.5f, -2.0f}, {1.0f, 0.0f, -2.0f}, "below it");
    expect_that_a_reset_leads_to(air, {1.0f, -1.1f, -2.0f}, {1.0f, 0.0f, -2.0f}, "within it");
    expect_that_a_reset_leads_to(air, {2.0f, -1.0f, 0.0f}, {0.0f, 0.0f, 0.0f}, "within a pillar");
    expect_that_a_reset_leads_to(air, {90.0f, -1.0f, 0.0f}, {0.0f, 0.0f, 0.0f}, "outside");
    const vec3 high_pillar(2.0f, 1.4f, 0.0f), start(0.0f, 0.0f, 4.0f);
    expect_that_a_reset_leads_to(high_pillar, {0.0f, -1.5f, 0.0f}, start, "no place at all");
}

// Whoever falls again and again from where they were put begins where the level does.
TEST(GameReset, WhereThereIsNoFloorTheLevelsStartIsNext) {
    SmallLevel level;
    level.begin();
    level.stand_at({30.0f, 0.0f, 0.0f});
    level.run(600);
    EXPECT_EQ(level.person().rescued(), 1u + simulation::Character::falls_before_home);
    EXPECT_NEAR(glm::length(level.foot() - vec3(0.0f, 0.0f, 4.0f)), 0.0f, 0.05f);
    // A single fall leads back to where they stood.
    level.stand_at({-4.0f, 0.0f, -2.0f});
    level.run(30);
    simulation::SimulationState state = level.world->simulation().state();
    state.person.foot = vec3(30.0f, 0.0f, 0.0f);
    state.person.grounded = false;
    level.world->simulation().restore(level.registry, state);
    level.run(200);
    EXPECT_NEAR(glm::length(level.foot() - vec3(-4.0f, 0.0f, -2.0f)), 0.0f, 0.05f);
}

// Turned by a quarter and twice as wide: the box, the entry and where the person looks.
TEST(GameReset, AreasTurnAndGrowWithTheirEntities) {
    SmallLevel level;
    scene::GameArea described;
    described.half_size = vec3(1.0f, 2.0f, 2.0f);
    described.entry = vec3(0.0f, -1.0f, 1.5f);
    const ecs::Entity area = level.area("area", {0.0f, 1.0f, 0.0f}, described);
    level.registry.patch<scene::Transform>(area, [](scene::Transform& t) {
        t.rotation = glm::angleAxis(0.5f * pi, vec3(0.0f, 1.0f, 0.0f)); // maps +Z to +X
        t.scale = vec3(1.0f, 1.0f, 2.0f);
    });
    level.begin();
    level.stand_at({0.0f, 0.0f, 1.2f});
    level.run(2);
    EXPECT_EQ(level.world->area(), nullptr) << "within its box if it were not turned";
    level.stand_at({-3.9f, 0.0f, 0.8f});
    level.run(2);
    ASSERT_EQ(level.world->area_entity(), area);
    EXPECT_TRUE(level.world->is_in(area, {3.9f, 1.0f, -0.9f}));
    EXPECT_FALSE(level.world->is_in(area, {4.1f, 1.0f, 0.0f}));
    level.press(simulation::button_reset);
    EXPECT_NEAR(level.foot().x, 3.0f, 0.05f);
    EXPECT_NEAR(level.foot().z, 0.0f, 0.05f);
    EXPECT_NEAR(level.person().forward().x, -1.0f, 1e-3f) << "along its -Z";
}

} // namespace
} // namespace sunfleck::demo

// Levels that load on a thread of their own.
#include "game_demo/level_loader.h"
#include "game_demo/walk_through.h"
#include "tests/support/gpu_world.h"

namespace sunfleck::tests {
namespace {

using LevelLoaderTest = GpuTest;
using namespace std::chrono_literals;

demo::DemoSettings small_settings() {
    demo::DemoSettings settings;
    settings.light_samples = 40;
    settings.render_scale = 0.5f;
    return settings;
}

TEST_F(LevelLoaderTest, WhatItHandsOverHasAllItsShadowMaps) {
    demo::LevelLoader loader(device(), {"four_pillars"}, small_settings());
    float last = 0.0f;
    while (!loader.finished()) {
        EXPECT_GE(loader.share(), last);
        last = loader.share();
        std::this_thread::sleep_for(1ms);
    }
    EXPECT_EQ(loader.share(), 1.0f);
    auto level = loader.take();
    ASSERT_TRUE(level) << level.error().message;
    EXPECT_EQ((*level)->renderer().statistics().counters["shadow_maps_stale"], 0u);
    EXPECT_GE((*level)->renderer().statistics().counters["light_samples"], 40u);
}

TEST_F(LevelLoaderTest, ItStopsWhereverItIs) {
    for (const auto wait : {0ms, 5ms, 60ms, 250ms}) {
        demo::LevelLoader loader(device(), {"four_pillars"}, small_settings());
        std::this_thread::sleep_for(wait);
    }
}

TEST_F(LevelLoaderTest, WhatCanNotBeLoadedIsNamed) {
    demo::LevelLoader loader(device(), {"no_such_level"}, small_settings());
    while (!loader.finished())
        std::this_thread::sleep_for(1ms);
    const auto level = loader.take();
    ASSERT_FALSE(level);
    EXPECT_NE(level.error().message.find("no_such_level"), std::string::npos) << level.error().message;
}

// A game that starts over has the world of a fresh start, to the bit, at every step, without loading it again.
TEST_F(LevelLoaderTest, ARestartedWorldIsAFreshOne) {
    auto level = demo::Level::load(device(), {"lantern_house"}, small_settings(), 2);
    ASSERT_TRUE(level) << level.error().message;
    const auto play = [&](int steps) {
        std::vector<std::uint64_t> hashes;
        demo::WalkThrough walk;
        for (int i = 0; i < steps; ++i) {
            if (i % 100 == 0)
                hashes.push_back((*level)->simulation().world_hash((*level)->renderer().registry()));
            (*level)->step(walk.next((*level)->simulation()));
        }
        return hashes;
    };
    const std::vector<std::uint64_t> fresh = play(700); // takes the lantern, opens a door, pushes a ball
    (*level)->restart();
    EXPECT_EQ(play(700), fresh);
    (*level)->restart();
    EXPECT_EQ(play(150), std::vector<std::uint64_t>(fresh.begin(), fresh.begin() + 2));
}

// Lifts far off never rest; what a player who stands still sees does, until its door opens.
TEST_F(LevelLoaderTest, WhatIsOutOfSightMovesNoPicture) {
    auto loaded = demo::Level::load(device(), {"lantern_game"}, small_settings(), 2);
    ASSERT_TRUE(loaded) << loaded.error().message;
    demo::Level& level = **loaded;
    ASSERT_TRUE(level.renderer().render_and_wait(level.request(small_settings(), 64, 36)));
    const auto stand = [&](const char* area) {
        const ecs::Entity entity = scene::find_by_name(level.game().registry(), area);
        const auto& described = level.game().registry().get<scene::GameArea>(entity);
        const vec3 centre(scene::world_matrix(level.game().registry(), entity)[3]);
        level.simulation().place_player(centre + described.entry, described.entry_facing);
        for (int k = 0; k < 90; ++k) // doors behind and before come to rest
            level.step({});
    };
    stand("area porch");
    for (int k = 0; k < 60; ++k) {
        level.step({});
        ASSERT_FALSE(level.moves()) << "step " << k;
    }
    simulation::StepInput turn;
    turn.turn = 20;
    level.step(turn);
    EXPECT_TRUE(level.moves());
    stand("area tower");
    int moving = 0; // the lift rests at its ends
    for (int k = 0; k < 14 * 60; ++k) {
        level.step({});
        moving += level.moves() ? 1 : 0;
    }
    EXPECT_GT(moving, 2 * 60);
}

// A level whose device is lost goes on, on another one, with the world that it had.
TEST_F(LevelLoaderTest, AMovedLevelHasTheSameWorld) {
    auto level = demo::Level::load(device(), {"lantern_house"}, small_settings(), 2);
    ASSERT_TRUE(level) << level.error().message;
    const auto hash = [](demo::Level& of) { return of.simulation().world_hash(of.renderer().registry()); };
    const auto play = [&](demo::Level& of, demo::WalkThrough& walk, int steps) {
        for (int i = 0; i < steps; ++i)
            of.step(walk.next(of.simulation()));
        return hash(of);
    };
    demo::WalkThrough walk;
    play(**level, walk, 400);
    const demo::WalkThrough walk_then = walk;
    const std::uint64_t then = hash(**level), whole = play(**level, walk, 300);
    (*level)->restart();
    walk = {};
    EXPECT_EQ(play(**level, walk, 400), then);
    const auto other = gpu::Device::create({});
    ASSERT_TRUE(other) << other.error().message;
    demo::LevelLoader loader(**other, std::move(*level), small_settings());
    while (!loader.finished())
        std::this_thread::sleep_for(1ms);
    level = loader.take();
    ASSERT_TRUE(level) << level.error().message;
    EXPECT_EQ(hash(**level), then);
    walk = walk_then;
    EXPECT_EQ(play(**level, walk, 300), whole);
    const viewer::FrameRequest request = (*level)->request(small_settings(), 64, 36);
    ASSERT_TRUE((*level)->renderer().render_and_wait(request));
    EXPECT_GE((*level)->renderer().statistics().counters["light_samples"], 40u);
    level->reset(); // before its device
}

// One that can't move, because it is called off, comes back.
TEST_F(LevelLoaderTest, ALevelThatDoesNotMoveComesBack) {
    auto level = demo::Level::load(device(), {"four_pillars"}, small_settings(), 2);
    ASSERT_TRUE(level) << level.error().message;
    demo::LevelLoader loader(device(), std::move(*level), small_settings());
    EXPECT_NE(loader.give_back(), nullptr);
}

} // namespace
} // namespace sunfleck::tests

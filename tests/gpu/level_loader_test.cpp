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

} // namespace
} // namespace sunfleck::tests

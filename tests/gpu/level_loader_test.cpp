// Levels that load on a thread of their own.
#include "game_demo/level_loader.h"
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
    demo::LevelLoader loader(device(), {"four_pillars"}, small_settings(), 160, 90);
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
        demo::LevelLoader loader(device(), {"four_pillars"}, small_settings(), 160, 90);
        std::this_thread::sleep_for(wait);
    }
}

TEST_F(LevelLoaderTest, WhatCanNotBeLoadedIsNamed) {
    demo::LevelLoader loader(device(), {"no_such_level"}, small_settings(), 160, 90);
    while (!loader.finished())
        std::this_thread::sleep_for(1ms);
    const auto level = loader.take();
    ASSERT_FALSE(level);
    EXPECT_NE(level.error().message.find("no_such_level"), std::string::npos) << level.error().message;
}

} // namespace
} // namespace sunfleck::tests

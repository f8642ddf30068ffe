// The demo's setting for precomputed transfer, while a level is played.
#include "game_demo/level_loader.h"
#include "tests/support/gpu_world.h"

namespace sunfleck::tests {
namespace {

using TransferInTheDemo = GpuTest;
using namespace std::chrono_literals;

TEST_F(TransferInTheDemo, ComplexMoversTakeItWhereItIsChosen) {
    setenv("XDG_CACHE_HOME", testing::TempDir().c_str(), 1);
    demo::DemoSettings settings;
    settings.light_samples = 40;
    settings.render_scale = 0.5f;
    settings.transfer = true;
    demo::LevelLoader loader(device(), {"four_pillars"}, settings);
    while (!loader.finished())
        std::this_thread::sleep_for(1ms);
    auto level = loader.take();
    ASSERT_TRUE(level) << level.error().message;
    const auto render = [&] {
        ASSERT_TRUE((*level)->apply(settings));
        ASSERT_TRUE((*level)->renderer().render_and_wait((*level)->request(settings, 160, 90)));
    };
    render();
    EXPECT_GT((*level)->renderer().statistics().counters["transfer_vertices"], 100u);
    settings.transfer = false; // in the middle of a game
    render();
    EXPECT_EQ((*level)->renderer().statistics().counters["transfer_vertices"], 0u);
    settings.transfer = true;
    render();
    EXPECT_GT((*level)->renderer().statistics().counters["transfer_vertices"], 100u);
}

} // namespace
} // namespace sunfleck::tests

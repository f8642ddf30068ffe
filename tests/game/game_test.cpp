// The game: its level can be solved, by reflected light only, and its world is the same however it is run.
#include "engine/core/jobs.h"
#include "tests/game/played_game.h"
#include "tests/support/test_size.h"

namespace sunfleck::demo {
namespace {

using tests::Played;
using tests::steps_a_minute;

TEST(Game, TheSolutionEndsIt) {
    Played played;
    played.solve();
    EXPECT_EQ(played.problem, "") << "after " << played.hashes.size() << " steps, at "
                                  << played.world->simulation().player().capsule().foot.x << " "
                                  << played.world->simulation().player().capsule().foot.z;
    EXPECT_TRUE(played.world->finished());
    EXPECT_GE(played.hashes.size(), 5 * steps_a_minute);
    EXPECT_EQ(played.world->simulation().player().rescued(), 0u);
    for (const auto& [name, share] : played.most) {
        EXPECT_GE(share, 1.25f) << name;
        std::printf("%s: %.2f of its threshold\n", name.c_str(), double(share));
    }
    std::printf("%zu steps; sensors took %.2f ms a step in the mean, %.2f at most\n", played.hashes.size(),
                played.sum_of_milliseconds / double(played.hashes.size()), played.milliseconds);
}

TEST(Game, DirectLightOpensNothing) {
    gi::SensorSettings direct;
    direct.sensors = gi::SensedLight::direct;
    Played played(direct);
    played.solve();
    EXPECT_FALSE(played.world->finished());
    EXPECT_LE(played.world->sensors_opened(), 1u);
}

// As the window does it: the game runs behind the title, and is then put back to its start.
TEST(Game, ARestartedWorldIsAsAFreshOne) {
    Played fresh, restarted;
    restarted.solve(400);
    ecs::copy_world(restarted.start, restarted.registry);
    ASSERT_TRUE(restarted.world->restart());
    restarted.hashes.clear();
    fresh.solve(900);
    restarted.solve(900);
    EXPECT_EQ(restarted.hashes, fresh.hashes);
}

TEST(Game, TheWorldIsTheSameOnOneThreadAndOnTwo) {
    const std::uint64_t steps = tests::by_size<std::uint64_t>(900, 15 * steps_a_minute);
    std::vector<std::uint64_t> hashes[2];
    for (const std::size_t threads : {std::size_t(1), std::size_t(2)}) {
        const ThreadLimit limit(threads);
        Played played;
        played.solve(steps);
        hashes[threads - 1] = played.hashes;
    }
    EXPECT_EQ(hashes[0], hashes[1]);
}

} // namespace
} // namespace sunfleck::demo

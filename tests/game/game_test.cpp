// The game: its level can be solved, by reflected light only, and its world is the same however it is run.
#include "engine/core/jobs.h"
#include "tests/game/played_game.h"
#include "tests/support/test_size.h"

#include <set>

namespace sunfleck::demo {
namespace {

using tests::Played;
using tests::steps_a_minute;

// What each sensor read at most until its door stood open.
class Openings {
public:
    void note(Played& played) {
        played.registry.view<scene::LightSensor, scene::SensorReading, scene::Name>().each(
            [&](ecs::Entity, const scene::LightSensor& sensor, const scene::SensorReading& reading,
                const scene::Name& name) {
                if (!reading.open)
                    return;
                const ecs::Entity door = scene::find_by_name(played.registry, sensor.opens);
                if (played.registry.get<scene::MoverState>(door).progress < 1.0f)
                    most_[name.name] = std::max(most_[name.name], reading.share);
            });
    }
    const std::map<std::string, float>& most() const { return most_; }

private:
    std::map<std::string, float> most_;
};

TEST(Game, TheSolutionEndsIt) {
    Played played;
    Openings openings;
    std::uint32_t rays = 0;
    played.watch = [&] {
        openings.note(played);
        rays = std::max(rays, played.hashes.size() > 1 ? played.world->sensors().rays() : 0u);
    };
    played.solve();
    EXPECT_EQ(played.problem, "") << "after " << played.hashes.size() << " steps, at "
                                  << played.world->simulation().player().capsule().foot.x << " "
                                  << played.world->simulation().player().capsule().foot.z;
    EXPECT_TRUE(played.world->finished());
    EXPECT_GE(played.hashes.size(), 5 * steps_a_minute);
    EXPECT_EQ(played.world->simulation().player().rescued(), 0u);
    EXPECT_EQ(openings.most().size(), played.most.size()) << "each sensor opens its door";
    for (const auto& [name, share] : openings.most()) {
        EXPECT_GE(share, 1.25f) << name;
        std::printf("%s: %.2f of its threshold\n", name.c_str(), double(share));
    }
    // Paths are chosen by how many rays they took the last time.
    EXPECT_LE(rays, 1.1 * gi::SensorSettings().sensor_rays) << "in a step";
    std::printf("%u rays in a step at most\n", rays);
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

// Each room by itself: the solution goes no further than to the first door that stays shut.
TEST(Game, DirectLightOpensAtMostOneOfAllDoors) {
    gi::SensorSettings direct;
    direct.sensors = gi::SensedLight::direct;
    std::set<std::string> opened;
    for (const char* room :
         {"area corner", "area red wall", "area shutters", "area blocks", "area colours", "area tower"}) {
        Played played(direct);
        played.enter(room);
        const ecs::Entity area = played.world->area_entity();
        Solution solution(*played.world);
        for (std::uint64_t k = 0; k < 3 * steps_a_minute && !solution.ended(); ++k) {
            played.step(solution.next());
            if (played.world->area_entity() != area)
                break;
        }
        for (const auto& [name, share] : played.most)
            if (share >= 1.0f)
                opened.insert(name);
        EXPECT_TRUE(played.world->sensors_opened() > 0 || !solution.problem().empty()) << room << " was not tried";
    }
    EXPECT_LE(opened.size(), 1u) << testing::PrintToString(opened);
}

// Where their maker put the entries, there is a floor: a reset leads to just there.
TEST(Game, EveryRoomIsResetToItsEntry) {
    Played played;
    std::vector<ecs::Entity> areas;
    played.registry.view<scene::GameArea>().each([&](ecs::Entity entity, const scene::GameArea& area) {
        if (!area.goal)
            areas.push_back(entity);
    });
    EXPECT_EQ(areas.size(), 8u);
    for (const ecs::Entity area : areas) {
        const auto& described = played.enter(played.registry.get<scene::Name>(area).name);
        ASSERT_EQ(played.world->area_entity(), area);
        played.world->reset_room();
        EXPECT_EQ(played.world->simulation().player().capsule().foot,
                  vec3(scene::world_matrix(played.registry, area)[3]) + described.entry)
            << described.title;
    }
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

// As after a lost device: the level lives on as a copy, with another store of meshes, while paths of its sensors wait
// to be followed once more.
TEST(Game, AWorldThatMovedIsAsOneThatStayed) {
    constexpr std::size_t least = 400, most = 700, steps = 900;
    const Played other; // its meshes are the same
    ecs::Registry copy;
    Played stayed, moved;
    stayed.solve(steps);
    Solution solution(*moved.world);
    while (moved.hashes.size() < least || moved.world->sensors().pending() == 0) {
        ASSERT_LT(moved.hashes.size(), most) << "nothing waits";
        moved.step(solution.next());
    }
    ecs::copy_world(moved.registry, copy);
    moved.world->continue_with(copy, other.meshes, nullptr);
    while (moved.hashes.size() < steps) {
        ASSERT_TRUE(moved.world->step(solution.next()));
        moved.hashes.push_back(moved.world->simulation().world_hash(copy));
    }
    EXPECT_EQ(moved.hashes, stayed.hashes);
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

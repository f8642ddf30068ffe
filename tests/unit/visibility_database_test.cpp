// The database of visibility: after any change it equals one that is built from scratch.
#include "tests/support/test_size.h"
#include "tests/support/visibility_world.h"

namespace sunfleck::gi {
namespace {

// A mover comes, goes, moves into a sample, anywhere, or a little.
void change_one(std::vector<MoverPlace>& movers, VisibilityWorld& world, std::uint32_t boxes, std::mt19937& random) {
    const std::uint32_t action = random() % 8;
    const std::size_t which = movers.empty() ? 0 : random() % movers.size();
    if ((action == 0 || movers.empty()) && movers.size() < 12)
        movers.push_back({world.registry.create(), random() % 2 ? boxes : 0, random_place(random)});
    else if (action == 1 && !movers.empty())
        movers.erase(movers.begin() + std::ptrdiff_t(which));
    else if (action == 2 && !movers.empty()) // into a sample
        movers[which].matrix[3] = vec4(world.samples[random() % world.samples.size()].position, 1.0f);
    else if (action < 5 && !movers.empty())
        movers[which].matrix = random_place(random);
    else if (!movers.empty())
        movers[which].matrix = glm::translate(mat4(1.0f), vec3(uniform(random, -0.1f, 0.1f))) * movers[which].matrix;
}

// The short size makes 200 changes, which do all that there is to do some 25 times each.
TEST(VisibilityDatabase, AfterThousandChangesItEqualsOneFromScratch) {
    VisibilityWorld world(assets::make_four_pillars, 150);
    const std::uint32_t boxes = world.meshes.add(scene::make_box(vec3(0.8f, 1.2f, 0.1f)));
    VisibilityDatabase database;
    database.build(world.registry, world.meshes, world.samples, {});
    std::mt19937 random(11);
    std::vector<MoverPlace> movers = world.places;
    database.update_movers(movers, world.meshes);
    std::uint64_t changes = 0;
    const int steps = tests::by_size(200, 1000);
    for (int step = 0; step < steps; ++step) {
        change_one(movers, world, boxes, random);
        std::shuffle(movers.begin(), movers.end(), random);
        database.begin_frame();
        database.update_movers(movers, world.meshes);
        changes += database.changes().size();
        if (step % 100 != 99)
            continue;
        VisibilityDatabase fresh;
        fresh.build(world.registry, world.meshes, world.samples, {});
        fresh.update_movers(movers, world.meshes);
        expect_equal(database, fresh, movers);
    }
    EXPECT_GT(changes, std::uint64_t(steps) * 100);
    EXPECT_GT(database.counters().full, 0u);
}

// Where there are more pairs than can be tested: the largest patches are as if all were tested, and of the others
// nothing is claimed that does not hold.
TEST(VisibilityDatabase, ScenesWithTooManyPairsAreDecidedCoarselyButSafely) {
    VisibilityWorld world(assets::make_four_pillars, 100);
    VisibilityOptions options;
    options.patches.levels = 0;
    VisibilityDatabase exact, coarse;
    ASSERT_TRUE(exact.build(world.registry, world.meshes, world.samples, options));
    const std::uint32_t nodes = exact.node_count();
    options.max_tests = std::uint64_t(nodes / 2) * 100;
    ASSERT_TRUE(coarse.build(world.registry, world.meshes, world.samples, options));
    ASSERT_EQ(coarse.node_count(), nodes);
    std::uint32_t same_rows = 0, settled = 0;
    for (std::uint32_t node = 0; node < nodes; ++node) {
        bool same = true;
        for (std::uint32_t sample = 0; sample < 100; ++sample) {
            const PairState is = coarse.static_state(node, sample), should = exact.static_state(node, sample);
            same = same && is == should;
            settled += is == PairState::full || is == PairState::unlit;
            // "Unlit" and "full" are both no light; where both hold, either may be found first.
            const bool dark = should == PairState::full || should == PairState::unlit;
            EXPECT_TRUE(is == should || is == PairState::partial ||
                        ((is == PairState::full || is == PairState::unlit) && dark))
                << "node " << node << ", sample " << sample << ": " << int(is) << " for " << int(should);
        }
        same_rows += same;
    }
    EXPECT_GE(same_rows, nodes / 2);
    EXPECT_GT(settled, 0u);
}

TEST(VisibilityDatabase, PairsThatNoBufferHoldsAreAnErrorThatNamesThem) {
    VisibilityWorld world(assets::make_four_pillars, 100);
    VisibilityOptions options;
    options.max_row_bytes = 1000;
    VisibilityDatabase database;
    EXPECT_FALSE(database.build(world.registry, world.meshes, world.samples, options));
    EXPECT_EQ(database.problem().code, ErrorCode::memory);
    EXPECT_NE(database.problem().message.find("100 light samples"), std::string::npos) << database.problem().message;
    EXPECT_EQ(database.node_count(), 0u);
}

TEST(VisibilityDatabase, ABuildThatIsStoppedLeavesNothingAndTheNextIsWhole) {
    VisibilityWorld world(assets::make_two_rooms, 60);
    VisibilityDatabase whole, stopped;
    float last = 0.0f;
    int reports = 0;
    EXPECT_TRUE(whole.build(world.registry, world.meshes, world.samples, {}, [&](float share) {
        EXPECT_LE(share, 1.0f);
        last = std::max(last, share);
        return ++reports > 0;
    }));
    EXPECT_GT(reports, 5);
    EXPECT_GT(last, 0.5f);
    for (int stop_at = 1; stop_at < reports; stop_at += 1 + reports / 4) {
        int calls = 0;
        const std::uint64_t before = stopped.generation();
        EXPECT_FALSE(
            stopped.build(world.registry, world.meshes, world.samples, {}, [&](float) { return ++calls < stop_at; }));
        EXPECT_EQ(calls, stop_at) << "called again after it said stop";
        EXPECT_EQ(stopped.node_count(), 0u);
        EXPECT_GT(stopped.generation(), before);
    }
    EXPECT_TRUE(stopped.build(world.registry, world.meshes, world.samples, {}));
    stopped.update_movers(world.places, world.meshes);
    whole.update_movers(world.places, world.meshes);
    expect_equal(stopped, whole, world.places);
}

TEST(VisibilityDatabase, ChangedSamplesAreDecidedAnew) {
    VisibilityWorld world(assets::make_two_rooms, 120);
    VisibilityOptions options;
    options.patches.levels = 0; // the same patches for every set of samples
    VisibilityDatabase database;
    database.build(world.registry, world.meshes, world.samples, options);
    database.update_movers(world.places, world.meshes);
    std::mt19937 random(3);
    std::vector<std::uint32_t> changed;
    for (std::uint32_t s = 0; s < world.samples.size(); s += 3) {
        world.samples[s].position += vec3(uniform(random, -0.3f, 0.3f), 0.0f, uniform(random, -0.3f, 0.3f));
        world.samples[s].normal = -world.samples[s].normal;
        changed.push_back(s);
    }
    database.change_samples(world.samples, changed);
    VisibilityDatabase fresh;
    fresh.build(world.registry, world.meshes, world.samples, options);
    fresh.update_movers(world.places, world.meshes);
    expect_equal(database, fresh, world.places);
}

// With rays, movers at their places.
void expect_agreement(VisibilityWorld& world, const VisibilityDatabase& database) {
    for (const MoverPlace& place : world.places)
        world.registry.patch<scene::WorldTransform>(place.entity, [&](auto& t) { t.matrix = place.matrix; });
    ASSERT_TRUE(world.rays->update(world.registry, world.meshes));
    const Agreement result = compare_with_rays(world, database, 16, 5);
    EXPECT_EQ(result.wrong_none, 0u);
    EXPECT_EQ(result.wrong_full, 0u);
}

// A third of every fifth sample; says which.
std::vector<std::uint32_t> move_some(std::vector<LightSample>& samples, std::mt19937& random) {
    std::vector<std::uint32_t> changed;
    for (std::uint32_t s = 0; s < samples.size(); s += 5)
        if (random() % 3 == 0) {
            samples[s].position =
                vec3(uniform(random, -1.2f, 1.2f), uniform(random, 0.1f, 3.4f), uniform(random, -1.2f, 1.2f));
            changed.push_back(s);
        }
    return changed;
}

// Samples of a light that is carried about, while objects move, too: as if built for them.
TEST(VisibilityDatabase, FollowsSamplesThatMove) {
    VisibilityWorld world(assets::make_four_pillars, 90);
    for (std::uint32_t s = 0; s < world.samples.size(); s += 5) {
        world.samples[s].dynamic = true;
        if (s % 2 == 0)
            world.samples[s].kind = SampleKind::point;
    }
    VisibilityDatabase database;
    database.build(world.registry, world.meshes, world.samples, {});
    std::mt19937 random(17);
    std::size_t changes = 0;
    for (int frame = 0; frame < 60; ++frame) {
        const std::vector<std::uint32_t> changed = move_some(world.samples, random);
        for (MoverPlace& place : world.places)
            if (random() % 2 == 0)
                place.matrix = random_place(random);
        database.begin_frame();
        database.change_samples(world.samples, changed);
        database.update_movers(world.places, world.meshes);
        changes += database.changes().size();
        for (const PairChange& change : database.changes())
            EXPECT_NE(change.before, change.after);
        if (frame % 20 != 19)
            continue;
        VisibilityDatabase fresh;
        fresh.build(world.registry, world.meshes, world.samples, {});
        fresh.update_movers(world.places, world.meshes);
        expect_equal(database, fresh, world.places);
        expect_agreement(world, database);
    }
    EXPECT_GT(changes, 10000u);
}

// The tests that clusters save are per mover: the short size has fewer.
TEST(VisibilityDatabase, ClustersSaveTestsAndChangeNothing) {
    VisibilityWorld world(assets::make_four_pillars, 300);
    std::vector<MoverPlace> movers;
    const std::uint32_t mesh = world.meshes.add(scene::make_box(vec3(0.25f)));
    std::mt19937 random(5);
    for (int i = 0; i < tests::by_size(30, 100); ++i)
        movers.push_back({world.registry.create(), mesh,
                          glm::translate(mat4(1.0f), vec3(uniform(random, -3.8f, 3.8f), uniform(random, 0.1f, 3.3f),
                                                          uniform(random, -3.8f, 3.8f)))});
    VisibilityDatabase clustered, plain, single;
    VisibilityOptions options;
    clustered.build(world.registry, world.meshes, world.samples, options);
    options.tests = TestGrouping::trees;
    plain.build(world.registry, world.meshes, world.samples, options);
    options.tests = TestGrouping::pairs;
    single.build(world.registry, world.meshes, world.samples, options);
    clustered.update_movers(movers, world.meshes);
    plain.update_movers(movers, world.meshes);
    single.update_movers(movers, world.meshes);
    expect_equal(clustered, plain, movers);
    expect_equal(single, plain, movers);
    const std::uint64_t all = movers.size() * clustered.patches().leaves() * world.samples.size();
    std::printf("tests: %llu clustered, %llu down the trees, %llu singly, %llu pairs\n",
                static_cast<unsigned long long>(clustered.counters().tests),
                static_cast<unsigned long long>(plain.counters().tests),
                static_cast<unsigned long long>(single.counters().tests), static_cast<unsigned long long>(all));
    EXPECT_LT(clustered.counters().tests, all / 10);
}

} // namespace
} // namespace sunfleck::gi

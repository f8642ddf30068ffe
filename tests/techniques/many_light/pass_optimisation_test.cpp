// Grouping of render passes against its definition: merging as the thesis does (fig. 4-10), and covering with extras.
#include "gi_module/many_light/pass_cover.h"
#include "gi_module/many_light/pass_optimisation.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace sunfleck::gi {
namespace {

PassLights random_set(std::mt19937& random, std::uint32_t lights, int base, int own, bool extras = false) {
    LightSet set((lights + 63) / 64, 0);
    // Neighbouring objects share runs of lights, as patches of one wall do.
    for (int i = 0; i < 40; ++i)
        set[std::size_t((base + i) % int(lights)) / 64] |= 1ull << ((base + i) % int(lights) % 64);
    for (int i = 0; i < own; ++i) {
        const std::uint32_t light = random() % lights;
        set[light / 64] |= 1ull << (light % 64);
    }
    PassLights result{set, set};
    if (extras)
        for (std::uint64_t& word : result.harmless)
            word |= std::uint64_t(random()) << 32 | random();
    return result;
}

// Each object is drawn for each of its lights exactly once, and for others only where that is harmless.
void expect_covered_once(const PassGrouping& grouping, const std::map<std::uint32_t, PassLights>& objects) {
    const auto has = [](const LightSet& set, std::uint32_t light) {
        return ((set[light / 64] >> (light % 64)) & 1u) != 0;
    };
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> drawn;
    for (const PassElement& element : grouping.elements())
        for (const std::uint32_t object : element.objects)
            for (std::uint32_t light = 0; light < element.lights.size() * 64; ++light)
                if (has(element.lights, light)) {
                    EXPECT_TRUE(has(objects.at(object).harmless, light));
                    ++drawn[{object, light}];
                }
    for (const auto& [object, lights] : objects)
        for (std::uint32_t light = 0; light < lights.needed.size() * 64; ++light)
            if (has(lights.needed, light)) {
                EXPECT_EQ((drawn[{object, light}]), 1);
            }
}

template <typename Grouping>
class PassGroupingTest : public testing::Test {};
using Groupings = testing::Types<PassOptimiser, PassCover>;
TYPED_TEST_SUITE(PassGroupingTest, Groupings);

TYPED_TEST(PassGroupingTest, CoversEveryPairOnceAndSavesPasses) {
    std::mt19937 random(8);
    for (const std::uint32_t lights_per_pass : {1u, 4u, 7u, 16u}) {
        std::map<std::uint32_t, PassLights> objects;
        for (std::uint32_t i = 0; i < 80; ++i)
            objects[i] = random_set(random, 300, int(i / 10) * 30, 8, lights_per_pass == 16);
        TypeParam grouping(lights_per_pass);
        grouping.update(objects);
        expect_covered_once(grouping, objects);
        if (lights_per_pass == 7) {
            EXPECT_LT(double(grouping.passes()), 0.5 * double(grouping.passes_unoptimised()));
        }
        EXPECT_LE(grouping.passes(), grouping.passes_unoptimised());
    }
}

TYPED_TEST(PassGroupingTest, ByHand) {
    // Two objects with the same 14 lights: 2 + 2 passes apart, 2 together. A third with 8 others: 2. All of it twice.
    TypeParam grouping(7);
    grouping.update({{1, {{0x3fff}, {0x3fff}}}, {2, {{0x3fff}, {0x3fff}}}, {3, {{0xff0000}, {0xff0000}}}});
    EXPECT_EQ(grouping.passes_unoptimised(), 12u);
    EXPECT_EQ(grouping.passes(), 8u);
    EXPECT_EQ(grouping.elements().size(), 2u);
    grouping.update({{2, {{0}, {0}}}});
    EXPECT_EQ(grouping.passes(), 8u);
    EXPECT_EQ(grouping.passes_unoptimised(), 8u);
    grouping.update({{3, {{0x1}, {0x1}}}}); // one light: one pass and one that only copies
    EXPECT_EQ(grouping.passes(), 8u);
}

TYPED_TEST(PassGroupingTest, MaintainedResultStaysCorrectAndNearlyAsGood) {
    std::mt19937 random(12);
    std::map<std::uint32_t, PassLights> objects;
    for (std::uint32_t i = 0; i < 60; ++i)
        objects[i] = random_set(random, 200, int(i / 6) * 20, 5);
    TypeParam maintained(7);
    maintained.update(objects);
    double worst = 0;
    for (int step = 0; step < 50; ++step) {
        std::map<std::uint32_t, PassLights> changed;
        for (int k = 0; k < 3; ++k) {
            const std::uint32_t object = random() % 60;
            changed[object] = random() % 10 == 0 ? PassLights{LightSet(4, 0), LightSet(4, 0)}
                                                 : random_set(random, 200, int(object / 6) * 20, 5, step % 2 == 1);
            objects[object] = changed[object];
        }
        maintained.update(changed);
        expect_covered_once(maintained, objects);
        TypeParam fresh(7);
        fresh.update(objects);
        worst = std::max(worst, double(maintained.passes()) / double(fresh.passes()));
    }
    EXPECT_LT(worst, 1.35);
}

// Objects that need 6 of 14 lights each, no two the same, and do not mind the other 8: one element holds all. Apart
// they are 20 elements; the thesis's merging, which knows no extras, keeps more than that of the passes.
TEST(PassGrouping, ExtrasFillPasses) {
    std::mt19937 random(3);
    std::map<std::uint32_t, PassLights> objects;
    for (std::uint32_t i = 0; i < 20; ++i) {
        LightSet needed(1, 0);
        while (light_count(needed) < 6)
            needed[0] |= std::uint64_t(1) << (random() % 14);
        objects[i] = {needed, {0x3fff}};
    }
    PassCover cover(7);
    cover.update(objects);
    expect_covered_once(cover, objects);
    EXPECT_EQ(cover.elements().size(), 1u);
    EXPECT_EQ(cover.passes(), 4u);
    EXPECT_NEAR(cover.fill(), 14.0 / 6.0, 1e-9);
    PassOptimiser merged(7);
    merged.update(objects);
    EXPECT_GT(merged.passes(), 20u);
    // One of them minds a light: it is drawn without it, or elsewhere.
    objects[4].harmless[0] &= ~(std::uint64_t(0x3fff) & ~objects[4].needed[0]);
    cover.update({{4, objects[4]}});
    expect_covered_once(cover, objects);
}

} // namespace
} // namespace sunfleck::gi

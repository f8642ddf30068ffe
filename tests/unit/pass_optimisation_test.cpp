// Merging of render passes (thesis fig. 4-10) against its definition.
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
void expect_covered_once(const PassOptimiser& optimiser, const std::map<std::uint32_t, PassLights>& objects) {
    const auto has = [](const LightSet& set, std::uint32_t light) {
        return ((set[light / 64] >> (light % 64)) & 1u) != 0;
    };
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> drawn;
    for (const PassElement& element : optimiser.elements())
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

TEST(PassOptimisation, CoversEveryPairOnceAndSavesPasses) {
    std::mt19937 random(8);
    for (const std::uint32_t lights_per_pass : {1u, 4u, 7u, 16u}) {
        std::map<std::uint32_t, PassLights> objects;
        for (std::uint32_t i = 0; i < 80; ++i)
            objects[i] = random_set(random, 300, int(i / 10) * 30, 8, lights_per_pass == 16);
        PassOptimiser optimiser(lights_per_pass);
        optimiser.update(objects);
        expect_covered_once(optimiser, objects);
        if (lights_per_pass == 7) {
            EXPECT_LT(double(optimiser.passes()), 0.5 * double(optimiser.passes_unoptimised()));
        }
        EXPECT_LE(optimiser.passes(), optimiser.passes_unoptimised());
    }
}

TEST(PassOptimisation, ByHand) {
    // Two objects with the same 14 lights: 2 + 2 passes apart, 2 together. A third with 8 others: 2. All of it twice.
    PassOptimiser optimiser(7);
    optimiser.update({{1, {{0x3fff}, {0x3fff}}}, {2, {{0x3fff}, {0x3fff}}}, {3, {{0xff0000}, {0xff0000}}}});
    EXPECT_EQ(optimiser.passes_unoptimised(), 12u);
    EXPECT_EQ(optimiser.passes(), 8u);
    EXPECT_EQ(optimiser.elements().size(), 2u);
    optimiser.update({{2, {{0}, {0}}}});
    EXPECT_EQ(optimiser.passes(), 8u);
    EXPECT_EQ(optimiser.passes_unoptimised(), 8u);
    optimiser.update({{3, {{0x1}, {0x1}}}}); // one light: one pass and one that only copies
    EXPECT_EQ(optimiser.passes(), 8u);
}

TEST(PassOptimisation, MaintainedResultStaysCorrectAndNearlyAsGood) {
    std::mt19937 random(12);
    std::map<std::uint32_t, PassLights> objects;
    for (std::uint32_t i = 0; i < 60; ++i)
        objects[i] = random_set(random, 200, int(i / 6) * 20, 5);
    PassOptimiser maintained(7);
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
        PassOptimiser fresh(7);
        fresh.update(objects);
        worst = std::max(worst, double(maintained.passes()) / double(fresh.passes()));
    }
    EXPECT_LT(worst, 1.35);
}

} // namespace
} // namespace sunfleck::gi

// What the game shows of a sensor, colour by colour, against what opens its door.
#include "game_demo/game/sensor_bars.h"

#include "engine/core/random.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace sunfleck::demo {
namespace {

scene::LightSensor needs(vec3 threshold, float purity) {
    return {threshold, purity, "", "", false};
}

scene::SensorReading of(const scene::LightSensor& sensor, vec3 irradiance) {
    return scene::next_reading(sensor, {}, irradiance);
}

TEST(SensorBars, ShowEachColourThatIsNeeded) {
    // Red is there, blue is not: the share alone says 0.
    const scene::LightSensor violet = needs(vec3(0.1f, 0.0f, 0.2f), 0.0f);
    const auto reading = of(violet, vec3(0.08f, 0.05f, 0.0f));
    const auto bars = sensor_bars(violet, reading);
    ASSERT_EQ(bars.size(), 2u);
    EXPECT_EQ(bars[0].channel, 0);
    EXPECT_FLOAT_EQ(bars[0].counts(), 0.8f);
    EXPECT_EQ(bars[1].channel, 2);
    EXPECT_FLOAT_EQ(bars[1].counts(), 0.0f);
    EXPECT_EQ(sensor_words(violet, reading), "red 80 %, blue 0 % of what it needs");
    const scene::LightSensor white = needs(vec3(0.5f), 0.0f);
    EXPECT_EQ(sensor_bars(white, of(white, vec3(0.4f, 0.5f, 0.1f))).size(), 3u);
    EXPECT_EQ(sensor_words(white, of(white, vec3(0.4f, 0.5f, 0.1f))), "gets 20 % of the light that it needs");
    EXPECT_EQ(sensor_words(white, of(white, vec3(0.6f))), "open");
    EXPECT_TRUE(sensor_bars(needs(vec3(0.0f), 1.0f), {}).empty());
}

TEST(SensorBars, ShowWhatCountsAgainstIt) {
    // Twice the red that it needs, and white light with it: of 2.0, the green takes 1.5.
    const scene::LightSensor red = needs(vec3(0.2f, 0.0f, 0.0f), 1.0f);
    const auto reading = of(red, vec3(0.4f, 0.3f, 0.1f));
    const auto bars = sensor_bars(red, reading);
    ASSERT_EQ(bars.size(), 1u);
    EXPECT_FLOAT_EQ(bars[0].gets, 2.0f);
    EXPECT_FLOAT_EQ(bars[0].taken, 1.5f);
    EXPECT_FLOAT_EQ(bars[0].counts(), 0.5f);
    EXPECT_EQ(sensor_words(red, reading), "red 50 % of what it needs\nother colours count against it");
}

// Whoever has all bars at the line has the door open.
TEST(SensorBars, TheLeastOfThemIsTheSensorsShare) {
    for (std::uint32_t i = 0; i < 200; ++i) {
        const auto number = [&](std::uint32_t dimension) { return to_unit_float(hash_combine(i, dimension)); };
        vec3 threshold(0.0f), irradiance(0.0f);
        for (int c = 0; c < 3; ++c) {
            threshold[c] = number(std::uint32_t(c)) < 0.4f ? 0.0f : 0.1f + number(std::uint32_t(c) + 3);
            irradiance[c] = 2.0f * number(std::uint32_t(c) + 6);
        }
        const scene::LightSensor sensor = needs(threshold, 0.5f * number(9));
        const auto bars = sensor_bars(sensor, of(sensor, irradiance));
        const auto least = std::min_element(
            bars.begin(), bars.end(), [](const SensorBar& a, const SensorBar& b) { return a.counts() < b.counts(); });
        EXPECT_NEAR(least == bars.end() ? 0.0f : least->counts(), scene::sensor_share(sensor, irradiance), 1e-5f) << i;
    }
}

} // namespace
} // namespace sunfleck::demo

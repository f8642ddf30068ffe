// The self-test's parts: triples of three programs, their file, and the rates that are drawn from them.
#include "editor/gate/self_test.h"
#include "engine/core/file.h"
#include "test_places.h"
#include "tests/support/test_size.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace sunfleck::gate {
namespace {

namespace fs = std::filesystem;

// Frames of one process: two passes and a stage, 1 % of noise in each frame, 0.3 % of luck in each process.
std::vector<Frame> process(std::mt19937& random, double light) {
    std::normal_distribution<double> normal(0.0, 1.0);
    const double luck_light = std::exp(0.003 * normal(random)), luck_maps = std::exp(0.003 * normal(random));
    std::vector<Frame> frames;
    for (std::uint32_t i = 0; i < 48; ++i) {
        Frame frame{i, 0.0, {}, {{"recording", 1.0}}, {{"maps", 24.0}}};
        frame.passes["light"] = 5.0 * light * luck_light * std::exp(0.01 * normal(random));
        frame.passes["shadow maps"] = 3.0 * luck_maps * std::exp(0.01 * normal(random));
        frame.frame_ms = 2.0 + frame.passes["light"] + frame.passes["shadow maps"];
        frames.push_back(frame);
    }
    return frames;
}

std::vector<Triple> made_up_triples(std::uint32_t count, double slow_light) {
    std::mt19937 random(5);
    std::vector<Triple> triples;
    for (std::uint32_t i = 0; i < count; ++i)
        triples.push_back({i,
                           "rebuild_" + std::to_string(i % 3),
                           "light",
                           {"device", "driver", "walk", "8x8", 600, false, {}},
                           process(random, 1.0),
                           process(random, 1.0),
                           process(random, slow_light)});
    return triples;
}

// Noise is small here: equal builds are always fine, and 5 % is always found.
TEST(GateSelfTest, RatesAreThoseOfTheRuns) {
    SelfTestOptions options;
    options.runs = tests::by_size(50u, 1000u);
    const SelfTestReport report = judge_triples(made_up_triples(30, 1.05), options).value();
    EXPECT_EQ(report.equal.runs, options.runs);
    EXPECT_EQ(report.equal.alarms, 0u);
    EXPECT_EQ(report.equal.fine, options.runs);
    ASSERT_EQ(report.slowed.size(), 1u);
    EXPECT_EQ(report.slowed[0].named, options.runs);
    EXPECT_EQ(report.slowed[0].fine, 0u);
    EXPECT_NEAR(report.slowed[0].slow_down, 0.05, 0.005);
    EXPECT_NEAR(report.slowed[0].share, 0.5, 0.03);
    ASSERT_FALSE(report.shifts.empty());
    EXPECT_LT(std::abs(report.shifts[0].ratio - 1.0), 0.01);
    // What is as fast as base is not caught, and a gate that always alarms would be seen.
    const SelfTestReport none = judge_triples(made_up_triples(30, 1.0), options).value();
    EXPECT_EQ(none.slowed[0].caught, 0u);
    EXPECT_EQ(none.slowed[0].fine, options.runs);
    EXPECT_NE(self_test_text(none).find("caught 0.0 %"), std::string::npos);
    // Nor is anything proven of 5 % by it.
    EXPECT_TRUE(none.slowed[0].below_harm);
    EXPECT_NE(self_test_text(none).find("less than the gate promises"), std::string::npos);
    EXPECT_FALSE(judge_triples(made_up_triples(30, 1.06), options).value().slowed[0].below_harm);
    EXPECT_FALSE(judge_triples(made_up_triples(5, 1.0), options));
}

// What was slowed is one pass, what got slower another.
TEST(GateSelfTest, SaysWhatWasNamedInstead) {
    SelfTestOptions options;
    options.runs = tests::by_size(20u, 200u);
    std::vector<Triple> triples = made_up_triples(30, 1.05);
    for (Triple& triple : triples)
        triple.slowed = "shadows";
    const SelfTestReport report = judge_triples(triples, options).value();
    EXPECT_EQ(report.slowed[0].caught, options.runs);
    EXPECT_EQ(report.slowed[0].named, 0u);
    EXPECT_EQ(report.slowed[0].others, (Culprits{{"light", options.runs}}));
    const std::string text = self_test_text(report);
    EXPECT_NE(text.find("named instead: 'light' " + std::to_string(options.runs)), std::string::npos) << text;
    EXPECT_EQ(text.find("alarms: '"), std::string::npos) << text;
}

class GateTriples : public testing::Test {
protected:
    void SetUp() override {
        folder = fs::path(testing::TempDir()) / ("sunfleck_triples_" + std::to_string(getpid()));
        fs::create_directories(folder);
    }
    void TearDown() override { fs::remove_all(folder); }
    fs::path folder;
};

TEST_F(GateTriples, ThreeProgramsDrawTheSameFrames) {
    const std::vector<std::string> fake = {SUNFLECK_FAKE, "x", "x"};
    std::vector<std::string> slow = fake;
    slow.insert(slow.end(), {"slow", "light", "by", "1.2"});
    for (std::uint32_t number = 0; number < 4; ++number) {
        const Triple triple = run_triple({fake, fake, slow}, {}, number, {}).value();
        constexpr std::size_t frames = 16 * 6;
        ASSERT_EQ(triple.base.size(), frames);
        double same = 0.0, slowed = 0.0;
        for (std::size_t i = 0; i < frames; ++i) {
            EXPECT_EQ(triple.base[i].number, triple.same[i].number);
            EXPECT_EQ(triple.base[i].number, triple.slow[i].number);
            same += triple.same[i].passes.at("light") / triple.base[i].passes.at("light") / frames;
            slowed += triple.slow[i].passes.at("light") / triple.base[i].passes.at("light") / frames;
        }
        // 2 % of noise in a frame and 0.3 % of luck: the three are not mixed up.
        EXPECT_NEAR(same, 1.0, 0.05);
        EXPECT_NEAR(slowed, 1.2, 0.06);
    }
    EXPECT_FALSE(run_triple({fake, fake, {"/bin/true"}}, {}, 0, {}));
}

TEST_F(GateTriples, MeasuringGoesOnWhereItWasCutOff) {
    const fs::path file = folder / "triples.jsonl";
    EXPECT_EQ(read_triples(file).value().size(), 0u);
    const std::vector<Triple> triples = made_up_triples(3, 1.0);
    ASSERT_TRUE(append_triple(file, triples[0]));
    ASSERT_TRUE(append_triple(file, triples[1]));
    const std::string whole = read_file(file).value();
    ASSERT_TRUE(write_file(file, whole.substr(0, whole.size() - 100)));
    EXPECT_EQ(read_triples(file).value().size(), 1u);
    ASSERT_TRUE(append_triple(file, triples[2]));
    const std::vector<Triple> read = read_triples(file).value();
    ASSERT_EQ(read.size(), 2u);
    EXPECT_EQ(read[1].number, 2u);
    EXPECT_EQ(read[1].rebuild, "rebuild_2");
    EXPECT_EQ(read[1].slow[7].passes, triples[2].slow[7].passes);
    ASSERT_TRUE(write_file(file, "{}\n"));
    EXPECT_FALSE(read_triples(file));
}

} // namespace
} // namespace sunfleck::gate

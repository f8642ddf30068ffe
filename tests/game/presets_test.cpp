// The game's world depends on no preset and on no number of steps a frame: the same input, with pictures and without.
#include "engine/core/file.h"
#include "engine/simulation/input_recording.h"
#include "game_demo/game/turning.h"
#include "tests/game/played_game.h"
#include "tests/support/command_line.h"
#include "tests/support/test_size.h"

#include <csignal>
#include <nlohmann/json.hpp>

namespace sunfleck::demo {
namespace {

namespace fs = std::filesystem;

using tests::CommandLine, tests::Outcome, tests::shell;

constexpr std::size_t walk_steps = 600;

// Runs; with a button there is something to look at and to use, too.
struct Leg {
    float x, z;
    std::uint32_t button = 0;
    vec3 look{0.0f};
};

// Takes the lantern, through the porch's door, round the corner until its door opens, and through that.
const Leg legs[] = {{0.35f, 9.0f, simulation::button_use, vec3(0.0f, 1.15f, 8.0f)},
                    {0.8f, 8.2f},
                    {0.0f, 6.9f},
                    {0.2f, 5.0f},
                    {2.0f, 3.4f},
                    {1.9f, 2.2f},
                    {-0.6f, 1.35f},
                    {0.0f, 0.7f},
                    {0.0f, -0.9f}};

bool there(const simulation::Character& person, const Leg& leg) {
    const vec3 foot = person.capsule().foot;
    return glm::length(vec2(leg.x - foot.x, leg.z - foot.z)) < 0.3f;
}

std::vector<simulation::StepInput> walk_through_two_doors() {
    tests::Played played;
    std::vector<simulation::StepInput> walk;
    walk.reserve(walk_steps);
    const simulation::Character& person = played.world->simulation().player();
    const auto step = [&](const simulation::StepInput& input) {
        played.step(input);
        walk.push_back(input);
    };
    for (const Leg& leg : legs) {
        float off = 1.0f;
        while (!there(person, leg) && walk.size() < walk_steps) {
            simulation::StepInput input = turn_to(person, vec3(leg.x, person.eye().y - 0.15f, leg.z), off);
            input.forward = off > 0.6f ? 0 : 100;
            step(input);
        }
        for (off = 1.0f; leg.button != 0 && off > 0.05f && walk.size() < walk_steps;)
            step(turn_to(person, leg.look, off));
        simulation::StepInput press;
        press.buttons = leg.button;
        if (leg.button != 0)
            step(press);
    }
    EXPECT_LT(person.capsule().foot.z, -0.24f) << "through the second door, after " << walk.size() << " steps";
    walk.resize(walk_steps);
    return walk;
}

struct Drawn {
    const char* preset;
    std::uint32_t steps_per_frame;
};

TEST_F(CommandLine, TheGameIsTheSameWithEveryPreset) {
    ASSERT_TRUE(simulation::write_recording(folder / "walk.txt", walk_through_two_doors()));
    const std::string common =
        "cd " + folder.string() + " && " SUNFLECK_DEMO " --headless --scene lantern_game --input walk.txt ";
    const Outcome simulated = shell(common + "--simulate -o simulated");
    ASSERT_EQ(simulated.status, 0) << simulated.output;
    const auto expected = nlohmann::json::parse(read_file(folder / "simulated/stats.json").value());
    ASSERT_EQ(expected["steps"], walk_steps);
    ASSERT_EQ(expected["opened"].size(), 1u) << "the corner's sensor opens its door";
    // In the short size, two presets and a few frames.
    const std::vector<Drawn> all = {{"software", 2}, {"low", 8},    {"software", 1}, {"software", 8}, {"low", 2},
                                    {"medium", 8},   {"high", 8},   {"ultra", 8},    {"medium", 1},   {"high", 2},
                                    {"low", 1},      {"medium", 2}, {"high", 1},     {"ultra", 1},    {"ultra", 2}};
    for (std::size_t i = 0; i < tests::by_size<std::size_t>(2, all.size()); ++i) {
        const Outcome outcome = shell(common + "-o drawn --size 64x36 --pictures 0 --preset " + all[i].preset +
                                      " --steps-per-frame " + std::to_string(all[i].steps_per_frame));
        ASSERT_EQ(outcome.status, 0) << outcome.output;
        const auto drawn = nlohmann::json::parse(read_file(folder / "drawn/stats.json").value());
        EXPECT_EQ(drawn["steps"], walk_steps);
        EXPECT_EQ(drawn["steps_hash"], expected["steps_hash"]) << "a step differs";
        EXPECT_EQ(drawn["world_hash"], expected["world_hash"]) << all[i].preset << " " << all[i].steps_per_frame;
        EXPECT_TRUE(drawn["cpu_ms"].contains("light sensors"));
    }
}

// From the title to the end with pictures, too; some two minutes, and so in the long size alone.
TEST_F(CommandLine, TheGamesWholeSolutionIsTheSameInSoftware) {
    if (!tests::long_size())
        GTEST_SKIP() << "of ./run bench game";
    constexpr std::size_t steps_per_frame = 8;
    const std::string demo = "cd " + folder.string() + " && " SUNFLECK_DEMO " --headless --scene lantern_game ";
    const Outcome solved = shell(demo + "--simulate -o solved --record solution.txt");
    ASSERT_EQ(solved.status, 0) << solved.output;
    auto solution = simulation::read_recording(folder / "solution.txt");
    ASSERT_TRUE(solution) << solution.error().message;
    solution->resize((solution->size() + steps_per_frame - 1) / steps_per_frame * steps_per_frame);
    ASSERT_TRUE(simulation::write_recording(folder / "whole.txt", *solution));
    const auto stats_of = [&](const std::string& options) {
        const Outcome outcome = shell(demo + "--input whole.txt -o played " + options);
        EXPECT_EQ(outcome.status, 0) << outcome.output;
        const auto text = read_file(folder / "played/stats.json");
        return text ? nlohmann::json::parse(*text, nullptr, false) : nlohmann::json::object();
    };
    const nlohmann::json expected = stats_of("--simulate");
    const nlohmann::json drawn =
        stats_of("--size 64x36 --pictures 0 --preset software --steps-per-frame " + std::to_string(steps_per_frame));
    ASSERT_EQ(expected["steps"], solution->size());
    EXPECT_GE(expected["opened"].size(), 5u);
    EXPECT_EQ(drawn["steps"], expected["steps"]);
    EXPECT_EQ(drawn["steps_hash"], expected["steps_hash"]) << "a step differs";
    EXPECT_EQ(drawn["world_hash"], expected["world_hash"]);
}

// A game that is played without pictures, and ended by a signal some time after its recording appeared.
Outcome play_until(const std::string& folder, const char* signal) {
    return shell("{ cd " + folder +
                 " && rm -f kept.txt; " SUNFLECK_DEMO
                 " --headless --simulate --scene lantern_game -o out --record kept.txt & game=$!; "
                 "while kill -0 $game && [ $(wc -c < kept.txt || echo 0) -lt 400 ]; do sleep 0.05; done 2>/dev/null; "
                 "cp kept.txt before.txt; sleep 0.3; kill -" +
                 signal + " $game; wait $game; }");
}

TEST_F(CommandLine, GamesWithoutPicturesAreRecordedWhileTheyArePlayed) {
    const auto steps = [&](const char* name) {
        const auto recording = simulation::read_recording(folder / name);
        EXPECT_TRUE(recording) << recording.error().message;
        return recording ? recording->size() : 0;
    };
    const Outcome killed = play_until(folder.string(), "KILL");
    ASSERT_EQ(killed.status, 128 + SIGKILL) << killed.output;
    EXPECT_GE(steps("kept.txt"), steps("before.txt"));
    EXPECT_GT(steps("kept.txt"), 10u);
    const Outcome stopped = play_until(folder.string(), "TERM");
    ASSERT_EQ(stopped.status, 128 + SIGTERM) << stopped.output;
    EXPECT_NE(stopped.output.find("SIGTERM"), std::string::npos) << stopped.output;
    EXPECT_GT(steps("kept.txt"), steps("before.txt")) << "what came after the last write";
    EXPECT_FALSE(fs::exists(folder / "out/stats.json")) << "of a game that did not end";
}

} // namespace
} // namespace sunfleck::demo

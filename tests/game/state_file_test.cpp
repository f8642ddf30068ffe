// The state that the window's game tells other programs: whole, the newest, and written by a thread of its own.
#include "game_demo/state_file.h"

#include "engine/core/file.h"
#include "tests/support/folder.h"

#include <gtest/gtest.h>

#include <future>
#include <nlohmann/json.hpp>

namespace sunfleck::demo {
namespace {

GameState state_of(std::uint64_t steps, std::function<std::string()> saved = {}) {
    GameState state;
    state.screen = "playing";
    state.progress.steps = steps;
    state.saved = std::move(saved);
    return state;
}

nlohmann::json told(const std::filesystem::path& path) {
    const auto text = read_file(path);
    return text ? nlohmann::json::parse(*text, nullptr, false) : nlohmann::json();
}

TEST(StateFile, TellsTheNewestStateAndKeepsNoFrameWaiting) {
    const tests::Folder folder("sunfleck_state");
    const auto path = folder.path / "state.json";
    StateFile file(path.string());
    std::promise<void> began, may_go_on;
    const auto slow = [&] {
        began.set_value();
        may_go_on.get_future().wait();
        return std::string("the game");
    };
    ASSERT_TRUE(file.write([&] { return state_of(1, slow); }));
    began.get_future().wait();
    for (std::uint64_t steps = 2; steps <= 9; ++steps) // would never return where frames wait for the file
        ASSERT_TRUE(file.write([&] { return state_of(steps); }));
    EXPECT_FALSE(std::filesystem::exists(path));
    may_go_on.set_value();
    ASSERT_TRUE(file.finish());
    EXPECT_EQ(told(path)["steps"], 9);
    EXPECT_EQ(told(path)["saved"], "");
    EXPECT_GT(told(path).value("state_ms", 0.0), 0.0);
    ASSERT_TRUE(file.write([&] { return state_of(10, [] { return std::string("the game"); }); }));
    ASSERT_TRUE(file.finish());
    EXPECT_EQ(told(path)["saved"], "the game");
}

TEST(StateFile, IsWrittenWhenItEndsAndNotWhereNothingChanged) {
    const tests::Folder folder("sunfleck_state");
    const auto path = folder.path / "state.json";
    {
        StateFile file(path.string());
        ASSERT_TRUE(file.write([] { return state_of(3); }));
    }
    EXPECT_EQ(told(path)["steps"], 3);
    StateFile file(path.string());
    ASSERT_TRUE(file.write([] { return state_of(4); }));
    ASSERT_TRUE(file.finish());
    std::filesystem::remove(path);
    ASSERT_TRUE(file.write([] { return state_of(4); }));
    ASSERT_TRUE(file.finish());
    EXPECT_FALSE(std::filesystem::exists(path)) << "it says what it said before";
}

TEST(StateFile, WithoutANameNothingIsAsked) {
    StateFile file("");
    ASSERT_TRUE(file.write([]() -> GameState {
        ADD_FAILURE() << "the state was asked for";
        return {};
    }));
    ASSERT_TRUE(file.finish());
}

TEST(StateFile, SaysWhatAWriteMet) {
    const tests::Folder folder("sunfleck_state");
    StateFile file((folder.path / "no_such_folder" / "state.json").string());
    ASSERT_TRUE(file.write([] { return state_of(1); }));
    EXPECT_FALSE(file.finish());
    EXPECT_FALSE(file.write([] { return state_of(2); }));
}

} // namespace
} // namespace sunfleck::demo

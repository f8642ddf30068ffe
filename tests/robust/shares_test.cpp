// Shares of what takes hours as a whole (./run bench robust --part 5 to 7): what programs that are killed leave, how
// the time to the first picture grows with the level, and whether memory grows from frame to frame.
#include "test_places.h"
#include "tests/support/run_tool.h"

#include <filesystem>
#include <gtest/gtest.h>

namespace sunfleck::tests {
namespace {

void expect_done(const std::string& script) {
    if (shell("command -v python3").status != 0)
        GTEST_SKIP() << "python3 is not installed";
    const std::filesystem::path build = std::filesystem::path(SUNFLECK_TOOL).parent_path().parent_path();
    const Outcome outcome =
        shell("python3 " SUNFLECK_SOURCE_DIR "/tests/robust/" + script + " '" + build.string() + "' share");
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    std::printf("%s", outcome.output.c_str());
}

TEST(RobustShares, TwiceTheObjectsTakeLittleMoreThanTwiceTheTime) {
    expect_done("scale.py");
}

TEST(RobustShares, KillsLeaveOldOrNewFiles) {
    expect_done("kills.py");
}

TEST(RobustShares, MemoryOfDemoAndToolDoesNotGrow) {
    expect_done("memory.py");
}

} // namespace
} // namespace sunfleck::tests

// Programs from outside: a folder of the test's own, exit status, messages.
#pragma once

#include "test_places.h"
#include "tests/support/run_tool.h"

#include <filesystem>
#include <gtest/gtest.h>
#include <vector>

namespace sunfleck::tests {

namespace fs = std::filesystem;

class CommandLine : public testing::Test {
protected:
    void SetUp() override {
        folder = fs::path(testing::TempDir()) / ("sunfleck_tool_" + std::to_string(getpid()));
        fs::create_directories(folder);
    }
    void TearDown() override { fs::remove_all(folder); }
    Outcome tool(const std::string& arguments, const std::string& before = "") {
        return shell("cd " + folder.string() + " && " + before + " " SUNFLECK_TOOL " " + arguments);
    }
    // One line that starts with "error:" and says each of `words`.
    void expect_clear_error(const Outcome& outcome, const std::vector<std::string>& words) {
        EXPECT_NE(outcome.status, 0) << outcome.output;
        EXPECT_LT(outcome.status, 128) << "crashed: " << outcome.output;
        for (const std::string& word : words)
            EXPECT_NE(outcome.output.find(word), std::string::npos) << "'" << word << "' in: " << outcome.output;
    }
    fs::path folder;
};

} // namespace sunfleck::tests

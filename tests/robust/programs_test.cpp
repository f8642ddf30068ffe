// What all programs have in common, from outside: how they end when memory is used up, when standard output is full,
// when they are interrupted, and what they do to files before and after.
#include "engine/core/caught.h"
#include "engine/core/exit_status.h"
#include "engine/core/file.h"
#include "engine/core/program_end.h"
#include "engine/core/user_folders.h"
#include "game_demo/options.h"
#include "test_places.h"
#include "tests/support/folder.h"
#include "tests/support/run_tool.h"

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <gtest/gtest.h>
#include <set>
#include <stdexcept>

namespace sunfleck {
namespace {

namespace fs = std::filesystem;
using tests::Outcome, tests::shell;

TEST(RobustExceptions, AreErrors) {
    const Status memory = caught([]() -> Status { throw std::bad_alloc(); });
    ASSERT_FALSE(memory);
    EXPECT_EQ(memory.error().code, ErrorCode::memory);
    const Result<int> other = caught([]() -> Result<int> { throw std::length_error("too long"); });
    ASSERT_FALSE(other);
    EXPECT_NE(other.error().message.find("too long"), std::string::npos);
    EXPECT_EQ(*caught([] { return Result<int>(3); }), 3);
    EXPECT_EQ(run_to_end([]() -> Status { throw std::bad_alloc(); }), exit_failed);
    EXPECT_EQ(run_to_end([]() -> Status { throw std::runtime_error("no file"); }), exit_failed);
    EXPECT_EQ(run_to_end([] { return Status(); }), exit_done);
}

class RobustPrograms : public testing::Test {
protected:
    Outcome in_folder(const std::string& command) const {
        return shell("cd '" + folder.path.string() + "' || exit; " + command);
    }
    std::set<std::string> files(const std::string& name) const {
        std::set<std::string> names;
        std::error_code code;
        for (const auto& entry : fs::directory_iterator(folder / name, code))
            names.insert(entry.path().filename().string());
        return names;
    }
    std::string content(const std::string& name) const {
        const auto text = read_file(folder / name);
        return text ? *text : "none";
    }
    tests::Folder folder{"sunfleck_programs"};
};

// Geometry that does not fit into the address space that is left.
TEST_F(RobustPrograms, TooLittleMemoryIsAMessage) {
    ASSERT_TRUE(
        write_file(folder / "large.scene.json", R"({"sunfleck_scene":2,"gltf":"large.glb","gltf_checksum":"0"})"));
    ASSERT_EQ(in_folder("truncate -s 1900M large.glb").status, 0);
    for (const char* program : {SUNFLECK_TOOL " info large.scene.json",
                                SUNFLECK_DEMO " --headless --simulate --scene large.scene.json -o out"}) {
        const Outcome outcome = in_folder("ulimit -v 1700000; " + std::string(program));
        EXPECT_EQ(outcome.status, exit_failed) << outcome.output;
        EXPECT_NE(outcome.output.find("out of memory"), std::string::npos) << outcome.output;
    }
}

TEST_F(RobustPrograms, HelpToAFullDiskFails) {
    for (const char* program : {SUNFLECK_TOOL, SUNFLECK_DEMO, SUNFLECK_EDITOR, SUNFLECK_GENERATE}) {
        EXPECT_EQ(in_folder(std::string(program) + " --help").status, exit_done) << program;
        const Outcome full = in_folder("( " + std::string(program) + " --help 2>&1 >/dev/full )");
        EXPECT_EQ(full.status, exit_failed) << program << ": " << full.output;
        EXPECT_NE(full.output.find("standard output"), std::string::npos) << program << ": " << full.output;
    }
    EXPECT_EQ(in_folder(SUNFLECK_GENERATE).status, exit_usage);
    EXPECT_EQ(in_folder(SUNFLECK_GENERATE " --what").status, exit_usage);
}

// Whatever is printed, of a command that does its work otherwise.
TEST_F(RobustPrograms, ResultsToAFullDiskFail) {
    fs::copy_file(fs::path(SUNFLECK_TOOL).parent_path() / "../scenes/cornell.glb", folder / "a.glb");
    ASSERT_TRUE(write_file(folder / "walk.rec", "sunfleck_input 1\n100 100 0 0 0 0\n"));
    const std::string render = " render cornell --size 8x6 --lights 4 --warmup 0 -o ";
    ASSERT_EQ(in_folder(SUNFLECK_TOOL + render + "a.png").status, exit_done);
    const std::string fake = " \"" SUNFLECK_FAKE " x x\"", gate = " bench compare" + fake + fake;
    for (const std::string& words : std::vector<std::string>{
             gate, " info", " info --json", " info --schema", " info --reference", " info a.glb", " info a.glb --json",
             " compare a.png a.png", " compare a.png a.png --json", " bench reference --repeat 1 --json",
             " bench level --scene cornell --input walk.rec --set lights=4 --size 8x6 --warmup 0 --frames 2"}) {
        const std::string command = SUNFLECK_TOOL + words;
        const Outcome fine = in_folder(command);
        EXPECT_EQ(fine.status, exit_done) << command << ": " << fine.output;
        const Outcome full = in_folder("( " + command + " 2>&1 >/dev/full )");
        // Of the gate, 1 is a verdict.
        const bool of_gate = words == gate || words.starts_with(" bench level");
        EXPECT_EQ(full.status, of_gate ? exit_usage : exit_failed) << command << ": " << full.output;
        EXPECT_TRUE(full.output.find("output: No space left") != std::string::npos ||
                    full.output.find("the disk may be full") != std::string::npos)
            << command << ": " << full.output;
        const std::size_t error = full.output.find("error:");
        EXPECT_EQ(full.output.find("error:", error + 1), std::string::npos) << command << ": " << full.output;
    }
    const Outcome graph = in_folder("( " SUNFLECK_TOOL + render + "b.png --print-graph 2>&1 >/dev/full )");
    EXPECT_EQ(graph.status, exit_failed) << graph.output;
    EXPECT_NE(graph.output.find("standard output"), std::string::npos) << graph.output;
}

// The disk is full when the scenes are written once more: all of the old ones are there.
TEST_F(RobustPrograms, ScenesAreOldOrNew) {
    ASSERT_EQ(in_folder(SUNFLECK_GENERATE " scenes").status, exit_done);
    const std::set<std::string> before = files("scenes");
    const std::string cornell = content("scenes/cornell.scene.json");
    ASSERT_EQ(before.count("cornell.scene.json"), 1u);
    const Outcome full = in_folder("ulimit -f 1; " SUNFLECK_GENERATE " scenes");
    EXPECT_EQ(full.status, exit_failed) << full.output;
    EXPECT_EQ(files("scenes"), before);
    ASSERT_EQ(in_folder(SUNFLECK_GENERATE " scenes").status, exit_done);
    EXPECT_EQ(files("scenes"), before) << "the files have the same names";
    EXPECT_EQ(content("scenes/cornell.scene.json"), cornell) << "and the same bytes: states of the reference go on";
}

// In what takes seconds before there is anything to save: while the first frame's light is made.
TEST_F(RobustPrograms, ProgramsEndWhereverTheyAreInterrupted) {
    for (const char* program : {SUNFLECK_DEMO " --headless --scene lantern_house --preset ultra --size 32x18 -o out",
                                SUNFLECK_TOOL " render lantern_house --lights 2000 --size 32x18 -o out.png",
                                SUNFLECK_TOOL " reference lantern_house --spp 100000 --size 320x180 -o out.exr"})
        for (const char* seconds : {"0.3", "1", "2", "3"}) {
            const Outcome outcome = in_folder("{ " + std::string(program) + " > log 2>&1 & P=$!; sleep " + seconds +
                                              "; B=$(date +%s%N); kill -INT $P; wait $P; S=$?; "
                                              "echo ms $((($(date +%s%N) - B) / 1000000)); exit $S; }");
            EXPECT_EQ(outcome.status, exit_stopped_by(SIGINT)) << program << outcome.output << content("log");
            const std::size_t number = outcome.output.find("ms ");
            ASSERT_NE(number, std::string::npos);
            // 0.3 s are asked for (0.18 measured on an idle machine); the rest is for one with other work.
            EXPECT_LT(std::atoi(outcome.output.c_str() + number + 3), 2000) << program << " after " << seconds << " s";
            EXPECT_FALSE(fs::exists(folder / "out.png"));
        }
}

TEST_F(RobustPrograms, StepsTryTheirOutputsFirst) {
    // The scene is none: whoever names it first has looked at the outputs too late.
    ASSERT_TRUE(write_file(folder / "scene.glb", "not a scene"));
    ASSERT_TRUE(write_file(folder / "walk.rec", "a recording"));
    const auto expect_error = [&](const std::string& arguments, const std::string& word) {
        const Outcome outcome = in_folder(SUNFLECK_DEMO " --headless --simulate --scene scene.glb " + arguments);
        EXPECT_EQ(outcome.status, exit_failed) << outcome.output;
        EXPECT_NE(outcome.output.find(word), std::string::npos) << word << " in: " << outcome.output;
    };
    expect_error("-o out --record out/stats.json", "--record");
    expect_error("-o out --record walk.rec --input walk.rec", "--input");
    expect_error("-o out --record scene.glb", "--scene");
    expect_error("-o out --record missing/walk.rec", "missing");
    expect_error("-o walk.rec", "walk.rec");
    expect_error("-o out", "scene.glb");
    EXPECT_EQ(content("walk.rec"), "a recording");
}

TEST_F(RobustPrograms, TheWindowTriesItsFilesFirst) {
    demo::Options options;
    EXPECT_TRUE(demo::check_window_files(options));
    options.state = (folder / "missing/state.json").string();
    EXPECT_FALSE(demo::check_window_files(options));
    options.state = (folder / "state.json").string();
    options.settings_file = (folder / "new/settings.json").string();
    EXPECT_TRUE(demo::check_window_files(options)) << "the folder of settings is made";
    options.settings_file = folder.path.string();
    EXPECT_FALSE(demo::check_window_files(options)) << "a folder";
}

TEST_F(RobustPrograms, UsersFoldersAreAbsoluteOrNone) {
    const auto folders = [] {
        return std::vector<fs::path>{user_settings_folder(), user_data_folder(), user_cache_folder()};
    };
    for (const char* variable : {"XDG_CONFIG_HOME", "XDG_DATA_HOME", "XDG_CACHE_HOME"})
        ::setenv(variable, "relative", 1);
    for (const char* home : {"", "relative", "./x"}) {
        ::setenv("HOME", home, 1);
        for (const fs::path& path : folders())
            EXPECT_TRUE(path.empty()) << path;
    }
    ::unsetenv("HOME");
    for (const fs::path& path : folders())
        EXPECT_TRUE(path.empty()) << path;
    ::setenv("HOME", "/h", 1);
    EXPECT_EQ(folders(),
              (std::vector<fs::path>{"/h/.config/sunfleck", "/h/.local/share/sunfleck", "/h/.cache/sunfleck"}));
}

} // namespace
} // namespace sunfleck

// `sunfleck bench compare` from outside, with programs that make their times up: verdicts, exit statuses, what it says
// of programs that misbehave, and what it leaves behind.
#include "engine/core/exit_status.h"
#include "engine/core/file.h"
#include "test_places.h"
#include "tests/support/run_tool.h"

#include <csignal>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <unistd.h>

namespace sunfleck {
namespace {

namespace fs = std::filesystem;
using tests::Outcome;
using tests::shell;

class GateProgram : public testing::Test {
protected:
    void SetUp() override {
        folder = fs::path(testing::TempDir()) / ("sunfleck_gate_" + std::to_string(getpid()));
        fs::create_directories(folder / "temporary");
    }
    void TearDown() override { fs::remove_all(folder); }

    std::string tool(const std::string& base, const std::string& head, const std::string& options) const {
        return "TMPDIR=" + (folder / "temporary").string() +
               " " SUNFLECK_TOOL " bench compare \"" SUNFLECK_FAKE " x x " + base + "\" \"" SUNFLECK_FAKE " x x " +
               head + "\" " + options;
    }
    Outcome compare(const std::string& base, const std::string& head, const std::string& options = "") const {
        return shell("cd " + folder.string() + " && " + tool(base, head, options));
    }
    static void expect(const Outcome& outcome, int status, const std::vector<std::string>& words) {
        EXPECT_EQ(outcome.status, status) << outcome.output;
        for (const std::string& word : words)
            EXPECT_NE(outcome.output.find(word), std::string::npos) << "'" << word << "' in: " << outcome.output;
    }
    // Ended, or waiting to be taken from the table of processes.
    static bool is_gone(int process) {
        const std::string file = "/proc/" + std::to_string(process) + "/stat";
        std::ifstream stat(file);
        std::string text;
        if (!std::getline(stat, text))
            return true;
        const std::size_t name_end = text.rfind(')');
        return name_end != std::string::npos && text.size() > name_end + 2 && text[name_end + 2] == 'Z';
    }
    // Neither a process nor a file stays.
    void expect_nothing_left() const {
        EXPECT_TRUE(fs::is_empty(folder / "temporary"));
        std::ifstream processes(folder / "processes");
        int process = 0, count = 0;
        for (; processes >> process; ++count) {
            for (int i = 0; i < 100 && !is_gone(process); ++i)
                usleep(20000); // what was killed takes a moment to go
            EXPECT_TRUE(is_gone(process)) << "process " << process << " is still there";
        }
        EXPECT_GT(count, 0);
    }
    fs::path folder;
};

// A process has 0.3 % of luck with a pass here, and 12 pairs tell 1 % from 0: these verdicts have no luck of their own.
TEST_F(GateProgram, EqualProgramsAreFine) {
    expect(compare("", ""), 0, {"fine"});
    EXPECT_TRUE(fs::is_empty(folder / "temporary"));
}

// One core to share, and a disk that fills up while the report is written.
TEST_F(GateProgram, PoorMachinesDoNotFoolIt) {
    const std::string in_folder = "cd " + folder.string() + " && ";
    expect(shell(in_folder + "taskset -c 0 env " + tool("", "", "")), 0, {"fine"});
    ASSERT_TRUE(write_file(folder / "report.html", "old"));
    expect(shell(in_folder + "(ulimit -f 4; " + tool("", "", "--report report.html") + ")"), 2, {"report.html"});
    EXPECT_EQ(read_file(folder / "report.html").value(), "old");
    expect(compare("", "", "--report report.html"), 0, {"fine"});
    EXPECT_GT(fs::file_size(folder / "report.html"), 10000u);
    EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 2) << "no temporary file stays";
}

TEST_F(GateProgram, ASlowerPassIsNamed) {
    expect(compare("", "slow light by 1.06"), 1, {"slower: 'light'", "ms"});
    expect(compare("", "slow recording by 1.06"), 1, {"slower: 'recording (CPU)'"});
    expect(compare("slow light by 1.06", ""), 0, {"fine"}); // faster
    expect(compare("", "add fog"), 1, {"slower: the whole frame", "'fog' is new in head"});
}

TEST_F(GateProgram, OneCounterOffByOneInOneFrameIsNamed) {
    expect(compare("", "count 417 off 1"), 4, {"the work changed", "'maps'", "28 -> 29 in frame 417"});
    expect(compare("", "count 599 off -1"), 4, {"'maps'", "28 -> 27 in frame 599"});
    expect(compare("", "count 0 off -1"), 4, {"'maps'", "24 -> 23 in frame 0"});
    expect(compare("", "count 417 off 1 slow light by 1.06"), 1, {"slower: 'light'", "'maps'"});
    expect(compare("", "count 417 off 1", "--accept-counters maps"), 0, {"fine", "changed as accepted"});
    expect(compare("", "count 417 off 1", "--accept-counters lights"), 4, {"'maps'"});
    expect(compare("", "", "--accept-counters mops"), 2, {"mops"});
}

TEST_F(GateProgram, TooFewPairsCannotTell) {
    expect(compare("", "slow light by 1.06", "--looks 2"), 3, {"cannot tell"});
}

TEST_F(GateProgram, ProgramsThatBreakGetOneMessage) {
    const std::pair<const char*, std::vector<std::string>> cases[] = {
        {"break 40 how crash", {"head", "Aborted"}},
        {"break 40 how exit", {"head", "status 7", "the disk is full"}},
        {"break 40 how hang", {"head", "did not answer within 1 s", "--time-limit"}},
        {"break 40 how skip", {"head", "frame 41", "frame 40"}},
        {"break 40 how nan", {"head", "frame 40", "JSON"}},
        {"break 40 how cut", {"head", "frame 40", "JSON"}},
        {"break 40 how empty", {"head", "frame 40", "JSON"}},
        {"break 40 how negative", {"head", "frame 40", "backwards"}},
        {"frames 20", {"number of frames", "'600'", "'20'"}},
        {"size 64x64", {"size", "320x180", "64x64"}},
        {"recording run", {"recording", "'walk'", "'run'"}},
        {"device other", {"device", "'made up'", "'other'"}},
        {"lights 300", {"setting 'lights'", "'200'", "'300'"}},
        {"hello good-day", {"head", "protocol", "good-day"}},
        {"hello {}", {"head", "sunfleck_gate"}},
    };
    for (const auto& [options, words] : cases) {
        const Outcome outcome = compare("", options, "--time-limit 1");
        expect(outcome, 2, words);
        EXPECT_EQ(outcome.output.rfind("error: "), outcome.output.find("error: ")) << outcome.output;
    }
    expect(compare("frames 20", "frames 20"), 2, {"20 frames"});
    expect(shell(SUNFLECK_TOOL " bench compare no_such_program other"), 2, {"no_such_program"});
    expect(shell(SUNFLECK_TOOL " bench compare /bin/true /bin/true"), 2, {"'/bin/true'", "status 0"});
    EXPECT_TRUE(fs::is_empty(folder / "temporary"));
}

// A revision takes minutes to build: what else is wrong on the command line is said first.
TEST_F(GateProgram, WrongOptionsAreNamedBeforeARevisionIsLookedFor) {
    const std::pair<std::string, std::string> tries[] = {
        {"--scene nope", "'nope'"},   {"--set nope=1", "'nope'"}, {"--input ./nope", "./nope"},
        {"--looks 12,12", "--looks"}, {"./nope", "./nope"},       {"", "git"}}; // the folder is none of git's
    for (const auto& [options, named] : tries) {
        const Outcome outcome = shell("cd " + folder.string() + " && TMPDIR=" + (folder / "temporary").string() +
                                      " " SUNFLECK_TOOL " bench compare --base no_such_revision " + options);
        expect(outcome, exit_usage, {named});
        EXPECT_EQ(outcome.output.find("git") == std::string::npos, !options.empty()) << outcome.output;
    }
    EXPECT_TRUE(fs::is_empty(folder / "temporary"));
}

TEST_F(GateProgram, NoProcessOutlivesIt) {
    for (const char* how : {"crash", "hang", "cut"}) {
        compare("child processes", std::string("child processes break 40 how ") + how, "--time-limit 0.5");
        expect_nothing_left();
    }
    compare("child processes", "child processes", "--looks 2");
    expect_nothing_left();
}

TEST_F(GateProgram, CtrlCEndsEverything) {
    const Outcome outcome =
        shell("cd " + folder.string() + "\n" +
              tool("child processes", "child processes break 40 how hang", "--time-limit 20") +
              " > log 2>&1 &\nP=$!\nfor i in $(seq 200); do [ -s processes ] && break; sleep 0.02; done\n"
              "sleep 0.3; kill -INT $P; wait $P; S=$?; cat log; exit $S");
    expect(outcome, exit_stopped_by(SIGINT), {"interrupted"});
    expect_nothing_left();
}

} // namespace
} // namespace sunfleck

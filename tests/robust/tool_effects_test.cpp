// Every option of the tool's other commands does something, as option_effects_test.cpp has it of `render` and
// `reference`: each that --help shows stands in the table with a value that lets the program say something else, makes
// a file or ends otherwise, or with the reason why that is not tried.
#include "engine/core/file.h"
#include "test_places.h"
#include "tests/support/gltf_files.h"
#include "tests/support/option_list.h"
#include "tests/support/run_tool.h"
#include "tests/support/test_size.h"

#include <algorithm>
#include <map>
#include <set>

namespace sunfleck::tests {
namespace {

enum class Shows { text, file, status, nothing };

struct ToolCase {
    std::string option;
    std::string rest;  // what the command line has beside it
    std::string value; // empty: it has none
    Shows shows = Shows::status;
    std::string what; // said with the option and not without it; a file's name; or why nothing is tried
};

using ToolCases = std::vector<ToolCase>;

ToolCase not_tried(const std::string& option, const std::string& why) {
    return {option, "", "", Shows::nothing, why};
}

ToolCases compare_cases() {
    return {{"--diff", "a.png b.png", "made.png", Shows::file, "made.png"},
            {"--json", "a.png b.png", "", Shows::text, "\"psnr\""}};
}

ToolCases info_cases() {
    return {{"--allow-outside", "in/out.scene.json", ""},
            {"--device", "", "nothing"},
            {"--json", "two.glb", "", Shows::text, "\"counts\""},
            {"--schema", "", "", Shows::text, "\"$schema\""},
            {"--reference", "", "", Shows::text, "# Settings, counters and views"}};
}

ToolCases bench_cases() {
    const std::string minutes = "of a suite that takes minutes";
    return {not_tried("--turns", minutes),
            {"--device", "reference --repeat 1", "nothing"},
            not_tried("--repeat", "what differs are times, which differ anyway"),
            {"--json", "reference --repeat 1", "", Shows::text, "\"rows\""},
            not_tried("--plot", minutes),
            {"--csv", "reference --repeat 1", "made.csv", Shows::file, "made.csv"},
            not_tried("--scene", minutes),
            not_tried("--part", minutes),
            not_tried("--views", minutes),
            not_tried("--spp", minutes),
            not_tried("--folder", minutes),
            not_tried("--memory", "no suite takes so much that a limit is met in seconds")};
}

// Two frames of two steps of a short recording.
const std::string of_level = "--scene cornell --input walk.rec --set lights=12 --size 16x9 --steps-per-frame 2 ";

// `rest` without one of its options.
std::string without_option(std::string rest, const std::string& option) {
    const std::size_t at = rest.find(option + " ");
    return rest.erase(at, rest.find(' ', at + option.size() + 1) + 1 - at);
}

ToolCases level_cases() {
    const std::string two = of_level + "--warmup 0 --frames 2 ";
    const auto without = [&](const char* option) { return without_option(two, option); };
    return {{"--size", without("--size"), "16x9", Shows::text, "\"size\":\"16x9\""},
            {"--preset", two, "ultra", Shows::text, "\"movers\":\"prt\""},
            {"--set", two, "bounces=0", Shows::text, "\"bounces\":0,"},
            {"--device", two, "nothing"},
            {"--input", without("--input"), "walk.rec"},
            {"--frames", without("--frames"), "1", Shows::text, "\"frames\":1,"},
            {"--steps-per-frame", without("--steps-per-frame"), "4", Shows::text, "\"frames\":25,"},
            {"--output", two, "made.json", Shows::file, "made.json"},
            {"--warmup", without("--warmup"), "1", Shows::text, "[{\"frame\":1,"},
            {"--serve", two, "", Shows::text, "'quit' is needed"},
            {"--scene", without("--scene"), "cornell", Shows::text, "\"scene\":\"cornell\""}};
}

// A command line of a program that makes its times up, as quickly as they are asked for.
std::string made_up(const std::string& options = "") {
    return "\"" SUNFLECK_FAKE " x x " + options + "\" ";
}

// What is handed on to programs, by one that says what it was given, and ends, where that is one of these.
const std::vector<std::pair<std::string, std::string>> handed_on = {{"--scene", "cornell"},     {"--size", "33x44"},
                                                                    {"--preset", "ultra"},      {"--set", "lights=12"},
                                                                    {"--steps-per-frame", "4"}, {"--device", "other"}};

// The self-test goes on where it was stopped, in a folder that has what it would build for hours.
ToolCases gate_cases() {
    const std::string equal = made_up() + made_up(), plays = "./plays.sh ./plays.sh --input walk.rec ";
    ToolCases cases = {{"--report", "base.json base.json", "made.html", Shows::file, "made.html"},
                       {"--accept-counters", "base.json head.json", "changed_counter"},
                       {"--base", equal, "no_such_revision"},
                       {"--stored", equal, "nothing"},
                       {"--looks", made_up() + made_up("slow light by 1.06"), "2", Shows::text, "cannot tell"},
                       {"--skip-work", made_up() + made_up("count 417 off 1"), ""},
                       {"--turns", made_up("frames 150") + made_up("frames 150"), "10000"},
                       not_tried("--seed", "which frames are drawn in which order is not said"),
                       not_tried("--time-limit", "300 s without it; in GateProgram.ProgramsThatBreakGetOneMessage"),
                       {"--input", "./plays.sh ./plays.sh ", "nothing"},
                       {"--self-test", "--triples 12 --rebuilds 2 ", "", Shows::text, "equal builds:"},
                       {"--triples", "--self-test --rebuilds 2 ", "154", Shows::text, "(77 triples)"},
                       {"--rebuilds", "--self-test --triples 12 ", "16", Shows::text, "building 'rebuild_16'"},
                       {"--folder", "--self-test --triples 12 --rebuilds 2 ", "made", Shows::text, "building 'base'"}};
    for (const auto& [option, value] : handed_on)
        cases.push_back({option, plays, value, Shows::text, option + " " + value});
    return cases;
}

ToolCases picture_cases() {
    const std::string stored = of_level + "--stored stored ";
    const auto without = [&](const char* option) { return without_option(stored, option); };
    return {{"--accept", stored, "", Shows::text, "wrote"},
            {"--stored", without("--stored"), "stored"},
            {"--input", without("--input"), "walk.rec"},
            {"--device", stored, "nothing"},
            {"--frame", stored, "b=1", Shows::text, "b                    frame     1"},
            {"--differences", stored + "--frame b=1 ", "made", Shows::file, "made/b_difference.png"},
            {"--size", without("--size"), "16x9"},
            {"--preset", stored, "ultra"},
            {"--set", stored, "bounces=0"},
            {"--time-limit", stored, "0.1"},
            {"--steps-per-frame", without("--steps-per-frame"), "2"},
            {"--scene", without("--scene"), "cornell"}};
}

const std::map<std::string, ToolCases>& tool_table() {
    static const std::map<std::string, ToolCases> table = {
        {"compare", compare_cases()},   {"info", info_cases()},          {"bench", bench_cases()},
        {"bench level", level_cases()}, {"bench compare", gate_cases()}, {"bench pictures", picture_cases()}};
    return table;
}

class RobustToolEffects : public testing::Test {
protected:
    // What it says and how it ends. It reads a line that no command knows.
    Outcome run(const std::string& words) const {
        return shell("cd '" + folder.path.string() + "' && rm -rf made* && echo nonsense | " SUNFLECK_TOOL " " + words);
    }
    void make(const std::string& words) const {
        const Outcome outcome = run(words);
        ASSERT_EQ(outcome.status, 0) << words << ": " << outcome.output;
    }
    // Once for all cases of the same words.
    const Outcome& plain(const std::string& words) {
        const auto known = plain_.find(words);
        return known != plain_.end() ? known->second : plain_[words] = run(words);
    }
    bool exists(const std::string& name) const { return std::filesystem::exists(folder / name); }

    void judge(const std::string& command, const ToolCase& of) {
        const std::string words = command + " " + of.rest, what = words + " " + of.option;
        const Outcome& before = plain(words);
        const Outcome after = run(words + " " + of.option + (of.value.empty() ? "" : " " + of.value));
        const std::string said = what + ": " + before.output.substr(0, 300) + "\n" + after.output.substr(0, 300);
        switch (of.shows) {
        case Shows::text:
            EXPECT_EQ(before.output.find(of.what), std::string::npos) << said;
            EXPECT_NE(after.output.find(of.what), std::string::npos) << said;
            break;
        case Shows::file:
            EXPECT_TRUE(exists(of.what)) << said;
            EXPECT_EQ(after.status, before.status) << said;
            break;
        case Shows::status:
            EXPECT_NE(after.status, before.status) << said;
            break;
        case Shows::nothing:
            break;
        }
    }
    // In the short size every fourth case is run; that all options are in the table is seen in both.
    void judge_all(const std::string& command) {
        const ToolCases& cases = tool_table().at(command);
        std::istringstream words(command);
        std::multiset<std::string> shown, known;
        for (const Option& option : options_of(Command{{std::istream_iterator<std::string>(words), {}}, {}}))
            shown.insert(option.name);
        for (const ToolCase& of : cases)
            known.insert(of.option);
        EXPECT_EQ(shown, known) << "--help of " << command << ", and this test's table";
        std::size_t tried = 0;
        for (std::size_t i = 0; i < cases.size(); i += by_size<std::size_t>(4, 1)) {
            if (cases[i].shows != Shows::nothing) {
                judge(command, cases[i]);
                ++tried;
            }
        }
        std::printf("%s: %zu options, %zu tried\n", command.c_str(), cases.size(), tried);
    }
    void write_recording() const {
        ASSERT_TRUE(write_file(folder / "walk.rec", "sunfleck_input 1\n100 100 0 0 0 0\n"));
    }

    // For the gate: see gate_cases.
    void make_programs() const {
        const auto write_program = [&](const std::filesystem::path& path, const std::string& lines) {
            ASSERT_TRUE(write_file(path, "#!/bin/sh\n" + lines + "exec " SUNFLECK_FAKE " x x\n", 0777));
        };
        std::string answers = "case \"$*\" in\n";
        for (const auto& [option, value] : handed_on)
            answers.append("*\"").append(option).append(" ").append(value).append("\"*) ;;\n");
        write_program(folder / "plays.sh", answers + "*) exec " SUNFLECK_FAKE " x x;;\nesac\n"
                                                     "echo \"given $*\" >&2\nexit 7\n");
        const std::filesystem::path prepared = folder / "build/gate/self-test";
        std::filesystem::create_directories(prepared / "bin");
        for (const char* name : {"base", "slow"})
            write_program(prepared / "bin" / name, "");
        for (int i = 1; i <= 15; ++i)
            write_program(prepared / "bin" / ((i < 10 ? "rebuild_0" : "rebuild_") + std::to_string(i)), "");
        ASSERT_TRUE(write_file(prepared / "amounts.json", R"({"shadow maps": 1, "low-resolution light": 1,
                                                              "g-buffer": 1, "visibility": 1})"));
        ASSERT_EQ(shell("cd '" + folder.path.string() + "' && git init -q").status, 0);
    }

    const Folder folder{"sunfleck_effects"};

private:
    std::map<std::string, Outcome> plain_;
};

TEST_F(RobustToolEffects, EachCommandHasATable) {
    for (const std::string& command : tool_commands())
        EXPECT_TRUE(command == "render" || command == "reference" || tool_table().count(command) == 1) << command;
}

TEST_F(RobustToolEffects, OfCompare) {
    make("render cornell -o a.png --size 8x6 --lights 4 --warmup 0");
    make("render cornell -o b.png --size 8x6 --lights 4 --warmup 0 --bounces 0");
    judge_all("compare");
}

TEST_F(RobustToolEffects, OfInfo) {
    GltfBuilder square;
    square.add_square();
    std::filesystem::create_directory(folder / "in");
    ASSERT_TRUE(write_file(folder / "two.glb", square.glb()));
    ASSERT_TRUE(write_file(folder / "in/out.scene.json", R"({"sunfleck_scene":2,"gltf":"../two.glb"})"));
    judge_all("info");
}

TEST_F(RobustToolEffects, OfBench) {
    judge_all("bench");
}

TEST_F(RobustToolEffects, OfBenchLevel) {
    write_recording();
    judge_all("bench level");
}

// Two files of `bench level`, which are of the same frames; the head's have a counter more.
TEST_F(RobustToolEffects, OfBenchCompare) {
    write_recording();
    make("bench level " + of_level + "--warmup 0 -o base.json");
    json level = json::parse(read_file(folder / "base.json").value());
    for (json& frame : level["each_frame"])
        frame["counters"]["changed_counter"] = 1;
    ASSERT_TRUE(write_file(folder / "base.json", level.dump()));
    for (json& frame : level["each_frame"])
        frame["counters"]["changed_counter"] = 2;
    ASSERT_TRUE(write_file(folder / "head.json", level.dump()));
    make_programs();
    judge_all("bench compare");
}

TEST_F(RobustToolEffects, OfBenchPictures) {
    write_recording();
    std::filesystem::create_directory(folder / "stored");
    make("bench pictures " + of_level + "--stored stored --accept --frame a=1 --frame b=30");
    judge_all("bench pictures");
}

} // namespace
} // namespace sunfleck::tests

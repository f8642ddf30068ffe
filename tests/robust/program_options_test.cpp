// Every option of the programs as they are, of whichever kind, with values that make no sense: exit status 2 with a
// message that names the option and what is allowed, or 1 with one that names what could not be had; no file is left.
// Flags, and options that a program has no use for, are taken.
#include "engine/core/file.h"
#include "test_places.h"
#include "tests/support/folder.h"
#include "tests/support/option_values.h"
#include "tests/support/run_tool.h"

#include <algorithm>

namespace sunfleck::tests {
namespace {

enum class Kind { flag, number, size, setting, choice, name };

Kind kind_of(const Option& option) {
    const auto begins = [&](const char* word) { return option.type.rfind(word, 0) == 0; };
    if (option.type.empty())
        return Kind::flag;
    if (range_of(option.type))
        return Kind::number;
    if (begins("WIDTHxHEIGHT"))
        return Kind::size;
    if (begins("NAME=VALUE"))
        return Kind::setting;
    return begins("TEXT") || begins("FILE") || begins("FOLDER") ? Kind::name : Kind::choice;
}

// What no option of the kind takes. Names have none in common but no name at all.
std::vector<std::string> wrong_values(Kind kind) {
    switch (kind) {
    case Kind::flag:
        return {"nan", "5x", "2", "TRUE "};
    case Kind::number:
        return {"nan", "", "99999999999999999999999999", "5x"};
    case Kind::size:
        return {"nan", "", "4294967297x1", "5x"};
    case Kind::setting:
        return {"nan", "", "no_such=1", "lights=5x"};
    case Kind::choice:
        return {"nan", "", "no_such", "5x"};
    case Kind::name:
        return {""};
    }
    return {};
}

// A short run; an option comes after it.
struct Program {
    std::string name, run;
};
const Program render{"render", SUNFLECK_TOOL " render cornell --size 16x9 --lights 4 --warmup 0"};
const Program reference{"reference", SUNFLECK_TOOL " reference cornell --size 16x9 --spp 1"};
const Program demo_walk{"demo", SUNFLECK_DEMO " --headless --size 16x9 --frames 1 --pictures 0"};

// All that there are. The tool's commands are those that --help lists; most are run without the words that they need
// beside options: a value that makes no sense is seen before that.
std::vector<Program> all_programs() {
    std::vector<Program> programs = {render, reference, demo_walk, {"editor", SUNFLECK_EDITOR}};
    for (const std::string& name : tool_commands())
        if (name != render.name && name != reference.name)
            programs.push_back({name, std::string(SUNFLECK_TOOL " ").append(name)});
    return programs;
}

struct RobustProgramOptions : testing::Test {
    static std::vector<Option> options(const Program& program) {
        return options_of(shell(program.run + " --help").output);
    }
    // What the run needs beside the option.
    static std::string rest(const Program& program, const std::string& option) {
        const std::string fake = " \"" SUNFLECK_FAKE " x x\"", tool = " " SUNFLECK_TOOL;
        if (program.name == "compare")
            return " a.png a.png";
        if (program.name == "info" || program.name == "editor")
            return "";
        if (program.name == "bench")
            return option == "--plot"     ? " convergence"
                   : option == "--scene"  ? " kernel"
                   : option == "--folder" ? " picture"
                                          : " reference --repeat 1";
        if (program.name == "bench level")
            return rest_of_level(option);
        if (program.name == "bench compare")
            return option == "--base" ? "" : is_of_level(option) ? tool + tool : fake + fake;
        if (program.name == "bench pictures")
            return rest_of_level(option) + (option == "--stored" ? "" : " --stored stored") +
                   (option == "--differences" ? " --frame a=10" : ""); // which differs
        const bool is_demo = program.name == "demo";
        std::string words;
        if (option != "--output")
            words += is_demo ? " -o out" : " -o out.png";
        if (is_demo && option != "--scene")
            words += " --scene cornell";
        return words;
    }
    static bool is_of_level(const std::string& option) {
        return option == "--scene" || option == "--input" || option == "--device";
    }
    static std::string rest_of_level(const std::string& option) {
        std::string words = " --set lights=4 --size 16x9 --steps-per-frame 2";
        words += option == "--scene" ? "" : " --scene cornell";
        return words + (option == "--input" ? "" : " --input walk.rec");
    }
    // For the programs as they are run here.
    void make_files() const {
        ASSERT_TRUE(write_file(folder / "walk.rec", "sunfleck_input 1\n100 100 0 0 0 0\n"));
        for (const std::string& command :
             {render.run + " -o a.png", std::string("git init -q"),
              SUNFLECK_TOOL " bench pictures --stored stored --accept --frame a=1" + rest_of_level("")}) {
            const Outcome made = shell("cd '" + folder.path.string() + "' && " + command);
            ASSERT_EQ(made.status, exit_done) << command << ": " << made.output;
        }
    }
    Outcome run(const Program& program, const std::string& words) const {
        return shell("( cd '" + folder.path.string() + "' && " + program.run + words + " 2>&1 >/dev/null )");
    }
    tests::Folder folder{"sunfleck_options"};
};

TEST_F(RobustProgramOptions, OfNoSenseAreNamedWithWhatIsAllowed) {
    std::size_t all = 0;
    for (const Program& program : all_programs()) {
        std::size_t tried = 0;
        for (const Option& option : options(program)) {
            const Kind kind = kind_of(option);
            for (const std::string& value : wrong_values(kind)) {
                std::string words = " " + option.name;
                words.append(value.empty() ? " " : "=").append("'").append(value).append("'");
                const Outcome outcome = run(program, words);
                expect_refused({outcome.status, outcome.output}, option, program.name + words);
                ++tried;
            }
        }
        EXPECT_GE(tried, 5u) << program.name;
        all += tried;
    }
    EXPECT_GE(all, 450u);
    std::printf("%zu tried\n", all);
    EXPECT_TRUE(std::filesystem::is_empty(folder.path));
}

// Options whose value a program has no use for: a name of nothing does no harm.
const char* unused_because(const Program& program, const std::string& option) {
    if (program.name == "reference" && option == "--device")
        return "the path tracer runs on the CPU";
    if (program.name == "demo" && (option == "--settings" || option == "--state" || option == "--screenshots"))
        return "it is of the window";
    if (program.name == "bench compare" && option == "--folder")
        return "it is of the self-test";
    return nullptr;
}

// 2: what the parser refuses, as it does folders that it looks for itself; and all errors of the gate.
int status_of_nothing(const Program& program, const Option& option) {
    const bool is_gate = program.name.starts_with("bench ");
    return is_gate || option.type == "FOLDER:DIR" ? exit_usage : exit_failed;
}

TEST_F(RobustProgramOptions, NamesOfNothingAreNamed) {
    make_files();
    std::size_t tried = 0, unused = 0;
    for (const Program& program : all_programs())
        for (const Option& option : options(program)) {
            if (kind_of(option) != Kind::name)
                continue;
            if (program.name == "editor" && option.name == "--device")
                continue; // looked for once there is a window
            const bool is_unused = unused_because(program, option.name) != nullptr;
            for (const std::string value : {"/proc/no_such.png", "/dev/null/x.png", "/proc/no_such/x.png"}) {
                // Last: some take more than one word.
                Outcome outcome = run(program, rest(program, option.name) + " " + option.name + " " + value);
                const std::string what = program.name + " " + option.name + " " + value + ": " + outcome.output;
                ++tried;
                if (is_unused) {
                    EXPECT_EQ(outcome.status, exit_done) << what;
                    ++unused;
                    std::filesystem::remove(folder.path / "out.png"); // it draws
                    break;
                }
                EXPECT_EQ(outcome.status, status_of_nothing(program, option)) << what;
                // Of a program that the gate has started, its message is told.
                if (const std::size_t told = outcome.output.find("it wrote: error:"); told != std::string::npos)
                    outcome.output.erase(told, 16);
                const std::size_t error = outcome.output.find(option.type == "FOLDER:DIR" ? option.name : "error:");
                ASSERT_NE(error, std::string::npos) << what;
                EXPECT_EQ(outcome.output.find("error:", error + 1), std::string::npos) << what;
                EXPECT_NE(outcome.output.find(value.substr(0, 9), error), std::string::npos) << what;
            }
        }
    EXPECT_GE(tried, 100u);
    EXPECT_FALSE(std::filesystem::exists(folder.path / "out.png"));
    std::printf("%zu tried, %zu of which are of no use to the program\n", tried, unused);
}

TEST_F(RobustProgramOptions, FlagsAreTaken) {
    const std::vector<std::string> others = {"--headless", "--simulate"}; // given already; plays for minutes
    std::size_t tried = 0;
    for (const Program& program : {render, reference, demo_walk})
        for (const Option& option : options(program)) {
            if (kind_of(option) != Kind::flag || std::count(others.begin(), others.end(), option.name) > 0)
                continue;
            const Outcome outcome = run(program, " " + option.name + rest(program, option.name));
            EXPECT_EQ(outcome.status, exit_done) << program.name << " " << option.name << ": " << outcome.output;
            ++tried;
        }
    EXPECT_GE(tried, 12u);
}

} // namespace
} // namespace sunfleck::tests

// Every option that --help shows, with values that make no sense: what the parser takes is in the range that help
// shows, and what it refuses is named, with the range, in one message and exit status 2.
#include "game_demo/command_line.h"
#include "gi_module/settings.h"
#include "tests/support/option_values.h"
#include "viewer/lost_devices.h"

#include <iterator>
#include <map>
#include <set>

namespace sunfleck::tests {
namespace {

// What a command needs beside options, by its name in --help.
const std::map<std::string, std::vector<std::string>>& needed_words() {
    static const std::map<std::string, std::vector<std::string>> list = {{"render", {"cornell", "-o", "x.png"}},
                                                                         {"reference", {"cornell", "-o", "x.png"}},
                                                                         {"compare", {"a.exr", "b.exr"}},
                                                                         {"bench", {"kernel"}},
                                                                         {"bench level", {}},
                                                                         {"bench compare", {"a"}},
                                                                         {"bench pictures", {"a", "--stored", "x"}},
                                                                         {"info", {}}};
    return list;
}

std::vector<Command> commands() {
    std::vector<Command> list;
    for (const std::string& name : tool_commands()) {
        const auto needed = needed_words().find(name);
        if (needed == needed_words().end())
            continue; // TheTableHasEachCommand fails
        std::istringstream words(name);
        list.push_back({{std::istream_iterator<std::string>(words), {}}, needed->second});
    }
    return list;
}

TEST(RobustOptions, TheTableHasEachCommand) {
    std::set<std::string> shown, known;
    for (const std::string& name : tool_commands())
        shown.insert(name);
    for (const auto& [name, words] : needed_words())
        known.insert(name);
    EXPECT_EQ(shown, known) << "--help, and what this test says that a command needs";
    for (const Command& command : commands()) {
        std::vector<std::string> words = command.words;
        words.insert(words.end(), command.rest.begin(), command.rest.end());
        const Verdict verdict = parse(words);
        EXPECT_EQ(verdict.status, exit_done) << verdict.message;
    }
}

Verdict read_demo(const std::vector<std::string>& words, demo::Options& options) {
    std::vector<const char*> arguments = {"sunfleck_demo"};
    for (const std::string& word : words)
        arguments.push_back(word.c_str());
    std::ostringstream text;
    const auto status = demo::read_command_line(int(arguments.size()), arguments.data(), options, text, text);
    return {status.value_or(exit_done), text.str()};
}
Verdict parse_demo(const std::vector<std::string>& words) {
    demo::Options options;
    return read_demo(words, options);
}

TEST(RobustOptions, EachOfTheDemosHasAnEffect) {
    expect_effects<demo::Options>(parse_demo, {}, [](const std::vector<std::string>& words) {
        demo::Options options;
        read_demo(words, options);
        return options;
    });
}

TEST(RobustOptions, TheParserTakesWhatHelpShowsAndNothingElse) {
    OptionCounts counts;
    for (const Command& command : commands())
        try_options(parse, command, counts);
    EXPECT_GE(counts.ranges, 25u) << "help shows fewer ranges than this test was written for";
    counts.print();
}

TEST(RobustOptions, TheDemosParserToo) {
    OptionCounts counts;
    demo::Options usual;
    read_demo({"--headless"}, usual);
    try_options(parse_demo, {{"--headless"}, {}}, counts, [&](const std::vector<std::string>& words) {
        demo::Options options;
        read_demo(words, options);
        return !(options == usual);
    });
    EXPECT_GE(counts.ranges, 6u);
    EXPECT_GE(counts.options, 18u);
    counts.print();
}

TEST(RobustOptions, BordersOfRangesAreIn) {
    for (const Command& command : commands())
        try_borders(parse, command);
    try_borders(parse_demo, {{"--headless"}, {}});
}

// --set NAME=VALUE of every lighting setting, as a scene file may have them, too.
TEST(RobustOptions, EverySettingTakesItsRangeAndNothingElse) {
    OptionCounts counts;
    for (const std::string_view name : gi::Settings::names()) {
        const Option setting{std::string(name), allowed_values(*gi::Settings::find(name))};
        try_values(
            parse, setting,
            [&](const std::string& value) {
                return std::vector<std::string>{"render", "cornell", "-o",
                                                "x.png",  "--set",   setting.name + "=" + value};
            },
            counts);
    }
    EXPECT_GE(counts.ranges, 20u);
    counts.print();
}

TEST(RobustDevices, WorkGoesOnOnNewDevicesTwice) {
    for (int losses = 0; losses <= 3; ++losses) {
        int runs = 0;
        const Status status = viewer::survive_lost_devices([&]() -> Status {
            return ++runs <= losses ? Status(Error{"submitting a frame failed", ErrorCode::device_lost}) : Status();
        });
        EXPECT_EQ(bool(status), losses < 3);
        EXPECT_EQ(runs, losses < 3 ? losses + 1 : 3);
    }
    int runs = 0;
    EXPECT_FALSE(viewer::survive_lost_devices([&]() -> Status {
        ++runs;
        return Error{"out of memory", ErrorCode::memory};
    }));
    EXPECT_EQ(runs, 1) << "only lost devices are worth another try";
}

} // namespace
} // namespace sunfleck::tests

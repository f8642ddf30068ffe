// Every option that --help shows, with values that make no sense: what the parser takes is in the range that help
// shows, and what it refuses is named, with the range, in one message and exit status 2.
#include "engine/core/exit_status.h"
#include "test_places.h"
#include "tests/support/option_list.h"
#include "tests/support/run_tool.h"
#include "viewer/lost_devices.h"

#include <cmath>
#include <cstdlib>
#include <gtest/gtest.h>
#include <optional>
#include <sstream>
#include <vector>

namespace sunfleck::tests {
namespace {

const std::vector<std::string>& hostile_values() {
    static const std::vector<std::string> values = {"",
                                                    " ",
                                                    "nan",
                                                    "NaN",
                                                    "inf",
                                                    "-inf",
                                                    "-1",
                                                    "-0",
                                                    "0",
                                                    "1e400",
                                                    "-1e400",
                                                    "1e-400",
                                                    "4294967296",
                                                    "4294967297",
                                                    "-4294967295",
                                                    "18446744073709551616",
                                                    "9223372036854775808",
                                                    "99999999999999999999999999",
                                                    "0x10",
                                                    "1,5",
                                                    "1.5.2",
                                                    "1..5",
                                                    "+5",
                                                    " 5",
                                                    "5 ",
                                                    "5x",
                                                    "1_000",
                                                    "true",
                                                    "null",
                                                    "[]",
                                                    "{}",
                                                    "'",
                                                    "%s%n",
                                                    "1;2",
                                                    "\xff\xfe",
                                                    "\xe2\x88\x9e",
                                                    "a\nb",
                                                    "../../x",
                                                    "4294967297x1",
                                                    std::string(100000, '9')};
    return values;
}

struct Range {
    bool whole = false;
    double low = 0, high = 0;
};

// "INT 1 to 60=5", "NUMBER -16 to 32", "0 to 64=5"; none for other types.
std::optional<Range> range_of(const std::string& type) {
    std::istringstream words(type);
    std::string word;
    words >> word;
    const bool named = word == "INT" || word == "NUMBER";
    Range range;
    range.whole = word == "INT";
    if (named)
        words >> word;
    char* end = nullptr;
    range.low = std::strtod(word.c_str(), &end);
    std::string to;
    if (*end != '\0' || !(words >> to) || to != "to" || !(words >> word))
        return std::nullopt;
    range.high = std::strtod(word.c_str(), nullptr);
    return range;
}

// The whole text is a plain decimal number within the range.
bool lies_in(const Range& range, const std::string& text) {
    if (text.empty() || text.find_first_not_of("0123456789.eE-") != std::string::npos)
        return false;
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    if (*end != '\0' || !std::isfinite(value) || value < range.low || value > range.high)
        return false;
    return !range.whole || text.find_first_of(".eE") == std::string::npos;
}

const std::vector<Command>& commands() {
    static const std::vector<Command> list = {{{"render"}, {"cornell", "-o", "x.png"}},
                                              {{"reference"}, {"cornell", "-o", "x.png"}},
                                              {{"compare"}, {"a.exr", "b.exr"}},
                                              {{"bench"}, {"kernel"}},
                                              {{"bench", "level"}, {}},
                                              {{"bench", "compare"}, {"a"}},
                                              {{"bench", "pictures"}, {"a", "--stored", "x"}},
                                              {{"info"}, {}}};
    return list;
}

void expect_refused(const Verdict& verdict, const Option& option, const std::string& what) {
    EXPECT_EQ(verdict.status, exit_usage) << what << ": " << verdict.message.substr(0, 300);
    EXPECT_NE(verdict.message.find(option.name), std::string::npos) << what << ": " << verdict.message.substr(0, 300);
}

TEST(RobustOptions, TheParserTakesWhatHelpShowsAndNothingElse) {
    std::size_t tried = 0, refused = 0, ranges = 0, options = 0;
    for (const Command& command : commands())
        for (const Option& option : options_of(command)) {
            ++options;
            if (option.type.empty())
                continue;
            const std::optional<Range> range = range_of(option.type);
            ranges += range.has_value();
            for (const std::string& value : hostile_values()) {
                std::vector<std::string> words = command.words;
                // "--name=" would take the next word for its value.
                words.push_back(value.empty() ? option.name : option.name + "=" + value);
                if (value.empty())
                    words.push_back(value);
                words.insert(words.end(), command.rest.begin(), command.rest.end());
                const Verdict verdict = parse(words);
                const std::string what =
                    command.words.back() + " " + option.name + "='" + value.substr(0, 40) + "' (" + option.type + ")";
                ++tried;
                refused += verdict.status != exit_done;
                if (range && !lies_in(*range, value))
                    expect_refused(verdict, option, what);
                else if (range && option.type.compare(0, 3, "INT") == 0)
                    EXPECT_EQ(verdict.status, exit_done) << what << ": " << verdict.message;
                else if (verdict.status != exit_done)
                    expect_refused(verdict, option, what);
            }
        }
    EXPECT_GE(ranges, 25u) << "help shows fewer ranges than this test was written for";
    std::printf("%zu options, %zu of them numbers: tried %zu values, refused %zu\n", options, ranges, tried, refused);
}

TEST(RobustOptions, BordersOfRangesAreIn) {
    for (const Command& command : commands())
        for (const Option& option : options_of(command)) {
            const std::optional<Range> range = range_of(option.type);
            if (!range)
                continue;
            const auto status = [&](double value) {
                char text[64];
                std::snprintf(text, sizeof text, range->whole ? "%.0f" : "%.17g", value);
                std::vector<std::string> words = command.words;
                words.push_back(option.name + "=" + text);
                words.insert(words.end(), command.rest.begin(), command.rest.end());
                return parse(words).status;
            };
            const double beyond = range->whole ? 1.0 : 0.001 * (range->high - range->low);
            EXPECT_EQ(status(range->low), exit_done) << option.name;
            EXPECT_EQ(status(range->high), exit_done) << option.name;
            EXPECT_EQ(status(range->low - beyond), exit_usage) << option.name;
            EXPECT_EQ(status(range->high + beyond), exit_usage) << option.name;
        }
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

// The program itself, for some of them: nothing on standard output, status 2, and no file left.
TEST(RobustOptions, ProgramsSayWhatIsWrongAndEnd) {
    for (const char* program : {SUNFLECK_TOOL " render cornell -o /nowhere/x.png", SUNFLECK_DEMO " --headless"}) {
        const std::string help = shell(std::string(program) + " --help").output;
        std::size_t tried = 0;
        for (const Option& option : options_of(help)) {
            if (!range_of(option.type))
                continue;
            for (const char* value : {"nan", "''", "99999999999999999999999999", "5x"}) {
                const Outcome outcome = shell(std::string(program) + " " + option.name + "=" + value);
                EXPECT_EQ(outcome.status, exit_usage) << option.name << " " << value << ": " << outcome.output;
                EXPECT_NE(outcome.output.find(option.name), std::string::npos) << outcome.output;
                ++tried;
            }
            if (tried >= 24)
                break;
        }
        EXPECT_GT(tried, 4u) << program;
    }
}

} // namespace
} // namespace sunfleck::tests

// Values that make no sense, and what a parser of options has to say to them: what it takes is in the range that help
// shows, and what it refuses is named, with the range.
#pragma once

#include "engine/core/exit_status.h"
#include "tests/support/option_list.h"

#include <cmath>
#include <cstdlib>
#include <functional>
#include <gtest/gtest.h>
#include <optional>
#include <sstream>
#include <vector>

namespace sunfleck::tests {

inline const std::vector<std::string>& hostile_values() {
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
                                                    "1e38",
                                                    "-1e38",
                                                    "1e20",
                                                    "1e-38",
                                                    "9007199254740992",
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
inline std::optional<Range> range_of(const std::string& type) {
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
inline bool lies_in(const Range& range, const std::string& text) {
    if (text.empty() || text.find_first_not_of("0123456789.eE-") != std::string::npos)
        return false;
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    if (*end != '\0' || !std::isfinite(value) || value < range.low || value > range.high)
        return false;
    return !range.whole || text.find_first_of(".eE") == std::string::npos;
}

struct OptionCounts {
    std::size_t options = 0, ranges = 0, tried = 0, refused = 0;
    void print() const {
        std::printf("%zu options, %zu of them numbers: tried %zu values, refused %zu\n", options, ranges, tried,
                    refused);
    }
};

// "1" and "60" of "INT 1 to 60=5", as help has them.
inline std::vector<std::string> ends_of(const std::string& type) {
    std::istringstream words(type.substr(0, type.find('=')));
    std::string word, before;
    while (words >> word && word != "to")
        before = word;
    words >> word;
    return {before, word.substr(0, word.find(','))};
}

// "on" and "off" of "on | off:{on,off}"; none of other types.
inline std::vector<std::string> choices_of(const std::string& type) {
    std::vector<std::string> choices;
    if (type.find(" | ") == std::string::npos)
        return choices;
    std::istringstream words(type.substr(0, type.find_first_of("=:")));
    for (std::string word; words >> word;)
        if (word != "|")
            choices.push_back(word);
    return choices;
}

// What a message says is allowed: a number's range, a choice's words, the form of all else that has one.
inline std::vector<std::string> allowed_by(const std::string& type) {
    if (range_of(type))
        return ends_of(type);
    for (const char* form : {"WIDTHxHEIGHT", "NAME=FRAME"})
        if (type.compare(0, std::string_view(form).size(), form) == 0)
            return {form};
    return choices_of(type);
}

inline void expect_refused(const Verdict& verdict, const Option& option, const std::string& what) {
    const std::string shown = what + ": " + verdict.message.substr(0, 300);
    EXPECT_EQ(verdict.status, exit_usage) << shown;
    EXPECT_NE(verdict.message.find(option.name), std::string::npos) << shown;
    for (const std::string& allowed : allowed_by(option.type))
        EXPECT_NE(verdict.message.find(allowed), std::string::npos) << shown << " (" << option.type << ")";
}

// "INT 1 to 60=5" and "5" or "5.0".
inline bool is_default(const std::string& type, const std::string& value) {
    const std::size_t equals = type.find('=');
    if (equals == std::string::npos)
        return false;
    const std::string usual = type.substr(equals + 1);
    return value == usual ||
           (range_of(type) && std::strtod(value.c_str(), nullptr) == std::strtod(usual.c_str(), nullptr));
}

// Whether a command line has another effect than the one without the option.
using Changes = std::function<bool(const std::vector<std::string>&)>;

// All values at one option. `words_of`: the whole command line, with a value. `changes`: of what is taken.
inline void try_values(const Parse& parse, const Option& option,
                       const std::function<std::vector<std::string>(const std::string& value)>& words_of,
                       OptionCounts& counts, const Changes& changes = {}) {
    const std::optional<Range> range = range_of(option.type);
    ++counts.options;
    counts.ranges += range.has_value();
    for (const std::string& value : hostile_values()) {
        const Verdict verdict = parse(words_of(value));
        const std::string what = option.name + "='" + value.substr(0, 40) + "' (" + option.type + ")";
        ++counts.tried;
        counts.refused += verdict.status != exit_done;
        if ((range && !lies_in(*range, value)) || verdict.status != exit_done)
            expect_refused(verdict, option, what);
        if (range && range->whole && lies_in(*range, value)) {
            EXPECT_EQ(verdict.status, exit_done) << what << ": " << verdict.message;
        }
        if (changes && verdict.status == exit_done && !is_default(option.type, value)) {
            EXPECT_TRUE(changes(words_of(value))) << what << " has no effect";
        }
    }
}

inline std::vector<std::string> with_option(const Command& command, const std::string& name, const std::string& value) {
    std::vector<std::string> words = command.words;
    if (value.empty()) // "--name=" would take the next word for its value
        words.insert(words.end(), {name, value});
    else
        words.push_back(name + "=" + value);
    words.insert(words.end(), command.rest.begin(), command.rest.end());
    return words;
}

// Of all options of a command that take a value.
inline void try_options(const Parse& parse, const Command& command, OptionCounts& counts, const Changes& changes = {}) {
    for (const Option& option : options_of(parse, command))
        if (!option.type.empty())
            try_values(
                parse, option, [&](const std::string& value) { return with_option(command, option.name, value); },
                counts, changes);
}

// Values that an option of this type takes, one of which is not its default.
inline std::vector<std::string> sensible_values(const std::string& type) {
    if (range_of(type))
        return ends_of(type);
    if (type.compare(0, 12, "WIDTHxHEIGHT") == 0)
        return {"33x44"};
    const std::vector<std::string> choices = choices_of(type);
    return choices.empty() ? std::vector<std::string>{"some_name", "/"} : choices; // some folders have to be there
}

// Each option of --help has an effect on what is read, of the type Options, from the command line.
template <typename Options>
void expect_effects(const Parse& parse, const Command& command,
                    const std::function<Options(const std::vector<std::string>&)>& read) {
    const Options usual = read(command.words);
    for (const Option& option : options_of(parse, command)) {
        bool differs = false;
        for (const std::string& value :
             option.type.empty() ? std::vector<std::string>{""} : sensible_values(option.type)) {
            std::vector<std::string> words = command.words;
            words.push_back(option.type.empty() ? option.name : option.name + "=" + value);
            differs = differs || !(read(words) == usual);
        }
        EXPECT_TRUE(differs) << option.name << " (" << option.type << ")";
    }
}

// Borders of ranges are in, and what lies beyond is not.
inline void try_borders(const Parse& parse, const Command& command) {
    for (const Option& option : options_of(parse, command)) {
        const std::optional<Range> range = range_of(option.type);
        if (!range)
            continue;
        const auto status = [&](double value) {
            char text[64];
            std::snprintf(text, sizeof text, range->whole ? "%.0f" : "%.17g", value);
            return parse(with_option(command, option.name, text)).status;
        };
        const double beyond = range->whole ? 1.0 : 0.001 * (range->high - range->low);
        EXPECT_EQ(status(range->low), exit_done) << option.name;
        EXPECT_EQ(status(range->high), exit_done) << option.name;
        EXPECT_EQ(status(range->low - beyond), exit_usage) << option.name;
        EXPECT_EQ(status(range->high + beyond), exit_usage) << option.name;
    }
}

} // namespace sunfleck::tests

// The options that the tool's --help shows.
#pragma once

#include "editor/command_line/program.h"

#include <algorithm>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

namespace sunfleck::tests {

struct Option {
    std::string name; // "--size"
    std::string type; // "INT 1 to 60"; empty: a flag
};

// Flags have their text after two spaces or more; values' types begin after one, and so do the options that one may not
// be given beside.
inline std::vector<Option> options_of(const std::string& help) {
    std::vector<Option> options;
    std::istringstream lines(help);
    for (std::string line; std::getline(lines, line);) {
        const std::size_t dashes = line.find("--");
        if (line.compare(0, 3, "  -") != 0 || dashes == std::string::npos)
            continue;
        const std::size_t end = line.find_first_of(" =", dashes);
        Option option{line.substr(dashes, end - dashes), {}};
        if (end != std::string::npos && line.compare(end, 2, "  ") != 0) {
            const std::size_t text = line.find("  ", end);
            option.type = line.substr(end + 1, text == std::string::npos ? text : text - end - 1);
            option.type.erase(std::min(option.type.find("Excludes: "), option.type.size()));
        }
        if (option.name != "--help")
            options.push_back(std::move(option));
    }
    return options;
}

struct Verdict {
    int status = 0;
    std::string message;
};

inline Verdict parse(const std::vector<std::string>& words) {
    std::vector<const char*> arguments = {"sunfleck"};
    for (const std::string& word : words)
        arguments.push_back(word.c_str());
    Verdict verdict;
    verdict.status = command_line::check_command_line(int(arguments.size()), arguments.data(), verdict.message);
    return verdict;
}

struct Command {
    std::vector<std::string> words, rest; // before and after the option
};

// Reads a command line, without its first word.
using Parse = std::function<Verdict(const std::vector<std::string>&)>;

inline std::vector<Option> options_of(const Parse& parse, const Command& command) {
    std::vector<std::string> words = command.words;
    words.emplace_back("--help");
    return options_of(parse(words).message);
}
inline std::vector<Option> options_of(const Command& command) {
    return options_of(parse, command);
}

// Names after "Subcommands:", a line each.
inline std::vector<std::string> subcommands_of(const std::string& help) {
    std::vector<std::string> names;
    std::istringstream lines(help);
    std::string line;
    while (std::getline(lines, line) && line != "Subcommands:") {
    }
    while (std::getline(lines, line) && !line.empty())
        if (line.compare(0, 2, "  ") == 0 && line[2] != ' ')
            names.push_back(line.substr(2, line.find(' ', 2) - 2));
    return names;
}

// All of the tool's commands that --help shows, those of commands behind them: "bench", "bench level".
inline std::vector<std::string> tool_commands(const std::vector<std::string>& before = {}) {
    std::vector<std::string> words = before, commands;
    words.emplace_back("--help");
    for (const std::string& name : subcommands_of(parse(words).message)) {
        std::vector<std::string> within = before;
        within.push_back(name);
        std::string command;
        for (const std::string& word : within)
            command += (command.empty() ? "" : " ") + word;
        commands.push_back(command);
        const std::vector<std::string> more = tool_commands(within);
        commands.insert(commands.end(), more.begin(), more.end());
    }
    return commands;
}

} // namespace sunfleck::tests

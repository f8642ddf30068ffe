// Runs a command line in a shell and takes what it prints.
#pragma once

#include <cstdio>
#include <string>
#include <sys/wait.h>

namespace sunfleck::tests {

struct Outcome {
    int status;         // 128 + the signal's number where one ended it
    std::string output; // standard output and error
};

inline Outcome shell(const std::string& command) {
    Outcome outcome{-1, {}};
    FILE* pipe = popen((command + " 2>&1").c_str(), "r");
    char buffer[4096];
    while (const std::size_t count = fread(buffer, 1, sizeof buffer, pipe))
        outcome.output.append(buffer, count);
    const int status = pclose(pipe);
    outcome.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return outcome;
}

} // namespace sunfleck::tests

// A child process that is spoken to line by line, with limits of time. It never outlives its object: the destructor
// ends it and all that it started in its process group.
#pragma once

#include "engine/core/result.h"

#include <functional>
#include <memory>
#include <string>
#include <sys/types.h>
#include <vector>

namespace sunfleck::gate {

// How long an answer may take, and whether the user wants to stop.
struct Patience {
    double seconds = 120.0;
    std::function<bool()> interrupted = [] { return false; };
};

class ChildProcess {
public:
    // `name`: what messages call it. The first argument is the program's file, found as the shell does.
    static Result<std::unique_ptr<ChildProcess>> start(std::string name, const std::vector<std::string>& arguments,
                                                       Patience patience);
    ~ChildProcess();
    ChildProcess(const ChildProcess&) = delete;
    ChildProcess& operator=(const ChildProcess&) = delete;

    Status send(const std::string& line);
    Result<std::string> read_line();
    // Closes its input and waits for its end; an exit status other than 0 is an error.
    Status finish();
    // The same, and all that it wrote on both of its streams.
    Result<std::string> read_to_end();

    const std::string& name() const { return name_; }
    pid_t process() const { return process_; }

private:
    ChildProcess(std::string name, Patience patience) : name_(std::move(name)), patience_(std::move(patience)) {}
    Status wait_for_output();
    bool read_available(int file, std::string& to);
    bool take_exit_status(bool wait);
    Error ended() const;
    bool failed() const;
    std::string last_words() const;
    void close_input();

    std::string name_;
    Patience patience_;
    pid_t process_ = -1;
    int input_ = -1, output_ = -1, errors_ = -1; // the child's standard files
    int exit_status_ = -1;                       // as waitpid has it
    bool running_ = false;
    std::string received_, complaints_;
};

// Words of a command line, separated by blanks; '...' and "..." keep blanks, without any other meaning.
Result<std::vector<std::string>> split_words(const std::string& command);

} // namespace sunfleck::gate

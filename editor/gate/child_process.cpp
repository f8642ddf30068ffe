#include "editor/gate/child_process.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

namespace sunfleck::gate {
namespace {

constexpr int poll_milliseconds = 50;                      // between looks at the clock and at Ctrl-C
constexpr std::size_t longest_line = std::size_t(1) << 24; // bytes
constexpr std::size_t complaints_kept = 2000;              // bytes, the last ones

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

// Three pipes; what is left open is closed at the end.
struct Pipes {
    int ends[3][2] = {{-1, -1}, {-1, -1}, {-1, -1}};
    ~Pipes() {
        for (auto& pair : ends)
            for (const int end : pair)
                if (end >= 0)
                    ::close(end);
    }
    bool open() {
        return std::all_of(std::begin(ends), std::end(ends),
                           [](int(&pair)[2]) { return ::pipe2(pair, O_CLOEXEC) == 0; });
    }
    int take(int pipe, int end) { return std::exchange(ends[pipe][end], -1); }
};

// The child gets the pipes as its standard files, a process group of its own and no signal handled in a special way.
int spawn(pid_t& process, const Pipes& pipes, char* const* arguments) {
    posix_spawn_file_actions_t files;
    posix_spawnattr_t attributes;
    posix_spawn_file_actions_init(&files);
    posix_spawnattr_init(&attributes);
    posix_spawn_file_actions_adddup2(&files, pipes.ends[0][0], 0);
    posix_spawn_file_actions_adddup2(&files, pipes.ends[1][1], 1);
    posix_spawn_file_actions_adddup2(&files, pipes.ends[2][1], 2);
    sigset_t defaults;
    sigemptyset(&defaults);
    for (const int signal : {SIGPIPE, SIGINT, SIGTERM, SIGXFSZ})
        sigaddset(&defaults, signal);
    posix_spawnattr_setsigdefault(&attributes, &defaults);
    posix_spawnattr_setpgroup(&attributes, 0);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
    const int code = ::posix_spawnp(&process, arguments[0], &files, &attributes, arguments, environ);
    posix_spawn_file_actions_destroy(&files);
    posix_spawnattr_destroy(&attributes);
    return code;
}

void set_non_blocking(int file) {
    ::fcntl(file, F_SETFL, ::fcntl(file, F_GETFL) | O_NONBLOCK);
}

} // namespace

Result<std::unique_ptr<ChildProcess>> ChildProcess::start(std::string name, const std::vector<std::string>& arguments,
                                                          Patience patience) {
    std::unique_ptr<ChildProcess> child(new ChildProcess(std::move(name), std::move(patience)));
    std::signal(SIGPIPE, SIG_IGN); // a child that is gone is seen as an error of write
    std::vector<char*> words;
    for (const std::string& argument : arguments)
        words.push_back(const_cast<char*>(argument.c_str()));
    words.push_back(nullptr);
    Pipes pipes;
    if (!pipes.open())
        return Error{child->name_ + ": cannot make pipes: " + std::strerror(errno)};
    if (const int code = spawn(child->process_, pipes, words.data()); code != 0)
        return Error{child->name_ + ": cannot run '" + arguments.front() + "': " + std::strerror(code)};
    child->running_ = true;
    child->input_ = pipes.take(0, 1);
    child->output_ = pipes.take(1, 0);
    child->errors_ = pipes.take(2, 0);
    for (const int file : {child->input_, child->output_, child->errors_})
        set_non_blocking(file);
    return child;
}

ChildProcess::~ChildProcess() {
    close_input();
    if (process_ > 0)
        ::kill(-process_, SIGKILL); // whoever is left of its group, too
    if (running_)
        take_exit_status(true);
    for (const int file : {output_, errors_})
        if (file >= 0)
            ::close(file);
}

void ChildProcess::close_input() {
    if (input_ >= 0)
        ::close(std::exchange(input_, -1));
}

Status ChildProcess::send(const std::string& line) {
    const std::string text = line + "\n"; // far less than a pipe holds
    const ssize_t written = ::write(input_, text.data(), text.size());
    if (written == ssize_t(text.size()))
        return {};
    if (errno == EAGAIN)
        return Error{name_ + " does not read what it is sent"};
    take_exit_status(false);
    return ended();
}

// False at the end of the file.
bool ChildProcess::read_available(int file, std::string& to) {
    char buffer[65536];
    for (;;) {
        const ssize_t count = ::read(file, buffer, sizeof buffer);
        if (count <= 0)
            return count < 0 && (errno == EAGAIN || errno == EINTR);
        to.append(buffer, std::size_t(count));
    }
}

Status ChildProcess::wait_for_output() {
    pollfd files[2] = {{output_, POLLIN, 0}, {errors_, POLLIN, 0}};
    ::poll(files, 2, poll_milliseconds);
    if (patience_.interrupted())
        return Error{"interrupted"};
    if (!read_available(errors_, complaints_))
        ::poll(nullptr, 0, 1); // closed: would be ready at once, again and again
    if (complaints_.size() > complaints_kept)
        complaints_.erase(0, complaints_.size() - complaints_kept);
    if (!read_available(output_, received_) && received_.find('\n') == std::string::npos) {
        take_exit_status(true);
        return ended();
    }
    return {};
}

Result<std::string> ChildProcess::read_line() {
    const Clock::time_point start = Clock::now();
    for (;;) {
        if (const std::size_t end = received_.find('\n'); end != std::string::npos) {
            std::string line = received_.substr(0, end);
            received_.erase(0, end + 1);
            return line;
        }
        if (received_.size() > longest_line)
            return Error{name_ + " wrote a line of more than " + std::to_string(longest_line) + " bytes"};
        if (seconds_since(start) > patience_.seconds)
            return Error{name_ + " did not answer within " + std::to_string(int(patience_.seconds)) +
                         " s (--time-limit); it was ended" + last_words()};
        SUNFLECK_TRY(wait_for_output());
    }
}

Status ChildProcess::finish() {
    close_input();
    const Clock::time_point start = Clock::now();
    while (!take_exit_status(false)) {
        if (patience_.interrupted())
            return Error{"interrupted"};
        if (seconds_since(start) > patience_.seconds)
            return Error{name_ + " did not end within " + std::to_string(int(patience_.seconds)) +
                         " s after 'quit' (--time-limit)"};
        std::string rest;
        read_available(output_, rest);
        read_available(errors_, complaints_);
        ::poll(nullptr, 0, 2);
    }
    return failed() ? Status(ended()) : Status();
}

bool ChildProcess::failed() const {
    return !WIFEXITED(exit_status_) || WEXITSTATUS(exit_status_) != 0;
}

Result<std::string> ChildProcess::read_to_end() {
    close_input();
    std::string output;
    const Clock::time_point start = Clock::now();
    while (!take_exit_status(false)) {
        pollfd files[2] = {{output_, POLLIN, 0}, {errors_, POLLIN, 0}};
        ::poll(files, 2, poll_milliseconds);
        if (patience_.interrupted())
            return Error{"interrupted"};
        if (seconds_since(start) > patience_.seconds)
            return Error{name_ + " did not end within " + std::to_string(int(patience_.seconds)) + " s"};
        read_available(output_, output);
        read_available(errors_, output);
        ::poll(nullptr, 0, 2); // streams that are closed would be ready again and again
    }
    read_available(output_, output);
    read_available(errors_, output);
    if (!failed())
        return output;
    constexpr std::size_t kept = 2000;
    return Error{name_ + " failed: " + (output.size() > kept ? output.substr(output.size() - kept) : output)};
}

bool ChildProcess::take_exit_status(bool wait) {
    if (!running_)
        return true;
    // A child that closed its output may still be on its way out; it is not waited for without end.
    const Clock::time_point start = Clock::now();
    for (;;) {
        const pid_t result = ::waitpid(process_, &exit_status_, WNOHANG);
        running_ = result == 0;
        if (!running_ || !wait)
            return !running_;
        if (seconds_since(start) > 2.0)
            ::kill(-process_, SIGKILL);
        ::poll(nullptr, 0, 2);
    }
}

Error ChildProcess::ended() const {
    std::string how = "closed its output";
    if (!running_ && WIFSIGNALED(exit_status_))
        how = std::string("was ended by a signal: ") + ::strsignal(WTERMSIG(exit_status_));
    else if (!running_ && WIFEXITED(exit_status_))
        how = "ended with status " + std::to_string(WEXITSTATUS(exit_status_));
    return Error{name_ + " " + how + " before the measurement was over" + last_words()};
}

std::string ChildProcess::last_words() const {
    std::string words = complaints_;
    while (!words.empty() && words.back() == '\n')
        words.pop_back();
    return words.empty() ? "" : "; it wrote: " + words;
}

Result<std::vector<std::string>> split_words(const std::string& command) {
    std::vector<std::string> words;
    bool in_word = false;
    char quote = 0;
    for (const char c : command) {
        if (quote == 0 && (c == ' ' || c == '\t')) {
            in_word = false;
            continue;
        }
        if (!in_word)
            words.emplace_back();
        in_word = true;
        if (c == quote)
            quote = 0;
        else if (quote == 0 && (c == '\'' || c == '"'))
            quote = c;
        else
            words.back() += c;
    }
    if (quote != 0)
        return Error{"'" + command + "' has a quote that is not closed"};
    if (words.empty() || words.front().empty())
        return Error{"a program is needed, not ''"};
    return words;
}

} // namespace sunfleck::gate

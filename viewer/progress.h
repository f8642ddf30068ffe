// How far a program's work is, for people who watch it.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

namespace sunfleck::viewer {

// A line on standard error that shows how far the work is; where standard error is no terminal, a line every ten
// percent.
class Progress {
public:
    explicit Progress(std::string what) : what_(std::move(what)) {}
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;
    // `share`: fraction done, 0 to 1.
    void show(double share, const std::string& detail);

private:
    std::string what_;
    int last_tenth_ = -1;
    bool drawn_ = false;
};

// For work in one piece, of which nobody knows how far it is: while this lives, a line on standard error after 10, 20,
// 40, ... seconds says that it goes on.
class Patience {
public:
    explicit Patience(std::string what);
    ~Patience();
    Patience(const Patience&) = delete;
    Patience& operator=(const Patience&) = delete;

private:
    std::mutex mutex_;
    std::condition_variable ended_;
    bool end_ = false;
    std::thread thread_;
};

// For work that may be quick: shows the share that is done from half a second on. False once a signal has asked for the
// end (engine/core/stop_signals.h).
std::function<bool(float)> progress_until_stopped(const std::string& what);

} // namespace sunfleck::viewer

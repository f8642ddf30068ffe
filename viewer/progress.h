// How far a program's work is, for people who watch it.
#pragma once

#include <functional>
#include <string>

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

// For work that may be quick: shows the share that is done from half a second on. False once a signal has asked for the
// end (engine/core/stop_signals.h).
std::function<bool(float)> progress_until_stopped(const std::string& what);

} // namespace sunfleck::viewer

// How far a program's work is, for people who watch it.
#pragma once

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

} // namespace sunfleck::viewer

// What the CPU did when: named stages, which may lie in one another.
#pragma once

#include <chrono>
#include <map>
#include <string>
#include <vector>

namespace sunfleck {

struct StageScope {
    std::string name;
    std::chrono::steady_clock::time_point begin, end;
};

// Milliseconds by name that belong to a scope and to none within it, so that no time counts twice; scopes of one name
// are summed. Of one thread's scopes (two of them are apart, or one lies in the other), in any order.
std::map<std::string, double> own_milliseconds(std::vector<StageScope> scopes);

// Sorts them as they began, a scope before those within it.
void sort_by_begin(std::vector<StageScope>& scopes);

// The scopes of one thread's work; a StageTimer adds one.
class StageTimes {
public:
    // Call with no timer under way.
    void clear() { scopes_.clear(); }
    // Those that have ended, in the order of their ends.
    const std::vector<StageScope>& scopes() const { return scopes_; }
    std::map<std::string, double> milliseconds() const { return own_milliseconds(scopes_); }

private:
    friend class StageTimer;
    std::vector<StageScope> scopes_;
};

// Adds a scope from its construction to its destruction. `times` must outlive it.
class StageTimer {
public:
    StageTimer(StageTimes& times, const char* stage)
        : times_(times), stage_(stage), begin_(std::chrono::steady_clock::now()) {}
    ~StageTimer();
    StageTimer(const StageTimer&) = delete;
    StageTimer& operator=(const StageTimer&) = delete;

private:
    StageTimes& times_;
    const char* stage_;
    std::chrono::steady_clock::time_point begin_;
};

} // namespace sunfleck

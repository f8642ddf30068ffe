// What the pairs say together: the verdict on times, and which counters moved.
#pragma once

#include "editor/gate/pair_driver.h"
#include "editor/gate/work_check.h"
#include "engine/statistics/gate.h"

#include <set>

namespace sunfleck::gate {

// A counter that was not the same in one and the same frame of base and head.
struct CounterChange {
    std::string name;
    std::uint32_t frame = 0;       // the first one that was drawn
    double base = 0.0, head = 0.0; // there
    std::uint32_t frames = 0;      // in which it differed
    std::uint32_t compared = 0;    // of so many
    bool accepted = false;
};

// For the report's plots.
struct FrameTime {
    std::uint32_t pair = 0, frame = 0;
    double base_ms = 0.0, head_ms = 0.0;
};

class Comparison {
public:
    // Counters that were meant to change.
    explicit Comparison(std::set<std::string> accepted = {}) : accepted_(std::move(accepted)) {}

    Status add(const PairRun& run);
    // Counters only.
    Status add(const WorkCheck& check);
    Result<statistics::GateReport> judge(const statistics::GateOptions& options) const;

    // What judge() judges: the names of passes and stages, and the pairs.
    std::vector<std::string> row_names() const;
    Result<std::vector<statistics::PairSummary>> summaries() const;

    std::uint32_t pairs() const { return std::uint32_t(runs_.size()); }
    std::vector<CounterChange> counter_changes() const;
    bool work_changed() const; // by a counter that was not accepted
    // Counters, and settings of the hello line, that only one of the two has.
    std::vector<std::string> notes() const;
    const std::vector<FrameTime>& frame_times() const { return frame_times_; }
    // Log ratios of the rows of judge(), pair after pair; 0 where there is none.
    std::vector<std::vector<double>> log_ratios() const;
    const Hello& base() const { return base_; }
    const Hello& head() const { return head_; }

private:
    struct Times {
        std::vector<double> frame_ms;
        std::vector<std::map<std::string, double>> rows; // passes and stages of each frame
    };
    struct Run {
        Times base, head;
    };
    Status take_hello(const Hello& base, const Hello& head);
    static void take(const Frame& frame, Times& times);
    void compare_counters(const Frame& base, const Frame& head);

    std::set<std::string> accepted_;
    Hello base_, head_;
    std::vector<Run> runs_;
    std::map<std::string, CounterChange> counters_;
    std::set<std::string> notes_;
    std::vector<FrameTime> frame_times_;
};

} // namespace sunfleck::gate

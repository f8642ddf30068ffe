// Frames that took much longer than those before, and why.
#pragma once

#include "engine/statistics/sample_series.h"
#include "viewer/scene_renderer.h"

#include <deque>
#include <string>
#include <vector>

namespace sunfleck::demo {

class HitchLog {
public:
    static constexpr std::size_t window = 30; // frames that a frame is compared with
    static constexpr double noticed = 2.0;    // times their median

    // A frame's time, ms, and what it was spent on. A frame of more than `noticed` times the median of the `window`
    // frames before gives a line that names the passes and stages that grew most.
    std::string add(double milliseconds, const viewer::FrameStatistics& statistics);
    // "470 frames: 99 % below 1.4 times the median of the 30 before, the longest 2.1, 1 above 2"
    std::string summary() const;

private:
    using Parts = std::map<std::string, double>; // ms
    std::string explain(double milliseconds, double usual, const Parts& parts) const;

    std::deque<std::pair<double, Parts>> before_;
    statistics::SampleSeries<double> ratios_;
    double longest_ = 0.0;
    std::size_t frames_ = 0, noticed_ = 0;
};

// The same for a window, written to the log.
class WindowHitches {
public:
    explicit WindowHitches(bool on) : on_(on) {}
    // For measurements of the start: what came when, in seconds.
    void log(const char* what, double seconds) const;
    // The time from frame to frame, presents included; the passes are those of the newest finished frame.
    void log(double seconds, const viewer::FrameStatistics& statistics);
    void log_summary() const;

private:
    bool on_;
    HitchLog log_;
};

} // namespace sunfleck::demo

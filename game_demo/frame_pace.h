// Holds a window's level to the player's time from frame to frame (FrameTimeControl), and says where that is not
// possible.
#pragma once

#include "game_demo/frame_time_control.h"
#include "game_demo/level.h"

#include <utility>

namespace sunfleck::demo {

class FramePace {
public:
    // Once a frame: with what the next one is drawn. `now`: s; `turns`: the view does. Nothing changes while the game
    // is not `playing`.
    FrameQuality choose(const DemoSettings& settings, Level& level, double now, bool turns, bool playing);
    // What a frame took until it was handed over, ms.
    void worked(double milliseconds) { work_ms_ = milliseconds; }
    // The shortest time from the start of one frame to the start of the next, s.
    double shortest_frame() const { return playing_ ? 1e-3 * control_.shortest_frame() : 0.0; }
    // False while frames take longer than the player's time with the least settings, too.
    bool reaches_target() const { return reaches_; }
    // One line for each target that cannot be reached; empty: nothing is to be said.
    std::string take_message() { return std::exchange(message_, {}); }

private:
    void tell(double target);

    FrameTimeControl control_;
    double work_ms_ = 0.0;
    double told_of_ = 0.0; // the target that was said to be out of reach
    bool playing_ = false, reaches_ = true;
    std::string message_;
};

} // namespace sunfleck::demo

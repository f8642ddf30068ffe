// Holds a window's frames to a time that the player chose, by what can change from frame to frame without a rebuild:
// the rendered size, the shadow maps that are drawn, and the samples that take a new strength. Clocks decide here, so
// only windows use it; headless runs, replays and the gate work by counts.
//
// The model: a frame takes fixed + (1 - fixed) * pixels of what it took, for a share `fixed` that is learned whenever
// the size changes. Once in two seconds at most another size is chosen, so that nineteen frames of twenty fit well into
// the target, since the next seconds are not as the last; between those moments, frames that are too long take maps
// away at once, and short ones give them back slowly. A frame that ends early waits, which evens the time between
// frames, and takes input later.
#pragma once

#include <cstdint>
#include <deque>

namespace sunfleck::demo {

struct FrameQuality {
    float render_scale = 0.5f;
    std::uint32_t maps = 24;            // shadow maps a frame
    std::uint32_t strength_budget = 16; // samples a frame that take a new strength
    bool operator==(const FrameQuality&) const = default;
};

class FrameTimeControl {
public:
    static constexpr double scale_interval = 2.0; // s: the size changes at most so often
    static constexpr float least_scale = 0.25f, scale_step = 1.0f / 32.0f;
    static constexpr std::uint32_t least_maps = 5, least_strength_budget = 4;
    static constexpr double most_time = 1.15; // of the target: nineteen frames of twenty are held below it

    // `usual`: the player's settings. Maps and strengths never exceed them; the scale may go up to 1. A target of 0,
    // ms, switches the control off: next() returns `usual`.
    void set(double target_ms, const FrameQuality& usual);
    // What next() chose last.
    const FrameQuality& quality() const { return quality_; }
    bool on() const { return target_ > 0.0; }

    // Once a frame: what the frame before took without its wait, ms, when this is, s, and whether anything in the
    // picture moves; at rest, the size stays.
    FrameQuality next(double work_ms, double now, bool moves);
    // The shortest time from the start of one frame to the start of the next, ms; 0: none.
    double shortest_frame() const { return on() ? wait_share * target_ : 0.0; }
    // With the least of everything, more than one frame in twenty still takes longer than `most_time` of the target;
    // until they fit again.
    bool out_of_reach() const { return out_of_reach_; }

private:
    static constexpr double wait_share = 0.87; // of the target
    void remember(double work_ms);
    void learn();
    void choose_scale(double now);
    void choose_maps(double work_ms);
    bool has_least() const;
    double usual() const; // median at the present size, ms
    double high() const;  // 95th percentile, ms
    double load() const;  // above 1, frames are too long

    double target_ = 0.0;
    FrameQuality usual_, quality_;
    std::deque<double> times_;   // work of frames at the present size, ms
    std::deque<double> history_; // and of those before, as if at the present size
    std::uint32_t skipped_ = 0;
    double changed_ = 0.0; // when the size did, s
    double maps_ = 0.0, last_ms_ = 0.0, fixed_ = 0.5;
    double before_ms_ = 0.0; // median at the size before; 0: unknown
    float before_scale_ = 0.0f;
    bool started_ = false, out_of_reach_ = false;
};

} // namespace sunfleck::demo

// How many shadow maps a frame may redraw if the budget is a time: estimated from the times of earlier frames. For
// interactive use, since pictures then depend on the machine's speed.
#pragma once

#include <cstdint>
#include <deque>

namespace sunfleck::gi {

class MapBudget {
public:
    // Frame `serial` redraws `maps` maps.
    void add_frame(std::uint64_t serial, std::uint64_t maps);
    // Their GPU time; serials ascend. Frames that were not added are ignored.
    void add_time(std::uint64_t serial, double milliseconds);
    // Maps that fit into the time, at least one; `unknown` while no time is known.
    std::uint32_t maps_in(double milliseconds, std::uint32_t unknown) const;

private:
    struct Frame {
        std::uint64_t serial, maps;
    };
    std::deque<Frame> frames_; // not measured yet, oldest first
    double milliseconds_per_map_ = 0.0;
};

} // namespace sunfleck::gi

// How many shadow maps a frame may redraw, if what is given is a time: from what earlier frames took. For interactive
// use, since pictures then depend on the machine's speed.
#pragma once

#include <cstdint>
#include <deque>

namespace sunfleck::gi {

class MapBudget {
public:
    // Frame `serial` redraws so many maps.
    void add_frame(std::uint64_t serial, std::uint64_t maps);
    // What the GPU took for them; serials rise. Frames that `drew` did not name are passed over.
    void add_time(std::uint64_t serial, double milliseconds);
    // Maps that fit, at least one; `unknown` while nothing is known.
    std::uint32_t maps_in(double milliseconds, std::uint32_t unknown) const;

private:
    struct Frame {
        std::uint64_t serial, maps;
    };
    std::deque<Frame> frames_; // not measured yet, oldest first
    double milliseconds_per_map_ = 0.0;
};

} // namespace sunfleck::gi

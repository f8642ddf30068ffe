// How much light that is approximated boils while things move: how far its error differs from one frame to the next.
#pragma once

#include "engine/io/image.h"

#include <optional>

namespace sunfleck::command_line {

// Of frames at equal steps of time: pictures, and what they approximate. Scene-linear. Pixels whose alpha is 0 in
// either do not count.
class FlickerMeter {
public:
    void add(const io::Picture& picture, const io::Picture& limit);

    // Mean of |picture - limit|^2 / (|limit|^2 + 0.01 m^2), m the mean of |limit|: relative MSE.
    double error() const { return frames_ > 0 ? error_ / frames_ : 0.0; }
    // The same of how the difference changes from frame to frame.
    double change() const { return frames_ > 1 ? change_ / (frames_ - 1) : 0.0; }
    // 1 for new noise in each frame, 0 for an error that stays.
    double flicker() const { return error() > 0.0 ? change() / (2.0 * error()) : 0.0; }

private:
    std::optional<io::Picture> last_; // difference, alpha 0 where it does not count
    double error_ = 0.0, change_ = 0.0;
    int frames_ = 0;
};

} // namespace sunfleck::command_line

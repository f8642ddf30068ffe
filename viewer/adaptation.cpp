#include "viewer/adaptation.h"

#include <algorithm>
#include <cmath>

namespace sunfleck::viewer {

float ExposureAdaptation::advance(float usual, std::optional<float> metered, double seconds) {
    constexpr float close_enough = 1.0f / 128.0f; // EV: less than a step of 8 bits anywhere
    if (metered)
        target_ = std::clamp(share * (*metered - lighter - usual), -reach, reach);
    if (!target_)
        return usual;
    if (!present_)
        present_ = target_;
    const float way = *target_ - *present_;
    if (std::abs(way) <= close_enough)
        present_ = target_;
    else
        *present_ += way * float(1.0 - std::exp(-seconds / double(way > 0.0f ? to_bright : to_dark)));
    return usual + *present_;
}

} // namespace sunfleck::viewer

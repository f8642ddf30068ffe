// Exposure that follows what the camera sees, as an eye adapts.
#pragma once

#include <optional>

namespace sunfleck::viewer {

// The scene's own exposure is what it looks best in; half of what the meter says beyond that is followed, in EV, and at
// most `reach`: dark rooms stay darker than bright ones. Rooms reflect about twice what a meter takes for grey, so they
// are shown one EV brighter than that. The way there is exponential, to brighter surroundings in about half a second,
// to darker ones in a second and a half. It ends: what stands still gets an exposure that stays.
class ExposureAdaptation {
public:
    static constexpr float share = 0.5f, reach = 2.0f, lighter = 1.0f; // the last two: EV
    static constexpr float to_bright = 0.5f, to_dark = 1.5f;           // s, to 63 % of a change

    // EV100 to be shown. `usual`: the scene's. `metered`: what viewer::automatic_exposure says of the newest picture
    // that was measured; none: nothing new. `seconds`: since the last call. The first measured picture is followed at
    // once.
    float advance(float usual, std::optional<float> metered, double seconds);
    // The next measured picture is followed at once.
    void forget() { target_.reset(), present_.reset(); }

private:
    std::optional<float> target_, present_; // relative to the usual one
};

} // namespace sunfleck::viewer

// Image error metrics.
#pragma once

#include "engine/io/image.h"

namespace sunfleck::command_line {

struct Metrics {
    double mean_a = 0, mean_b = 0; // over channels and compared pixels
    double mean_absolute_error = 0, maximum_error = 0, root_mean_square_error = 0;
    // Mean of |A-B|^2 / (|B|^2 + 0.01 m^2), |.|^2 summed over RGB, m the mean of |B|.
    double relative_mean_square_error = 0;
    double peak_signal_to_noise = 0; // dB; the peak is 1 for display values, B's maximum for scene-linear ones
    double structural_similarity = 0;
    double flip = 0;
    std::uint64_t pixels = 0, left_out = 0; // compared, and ignored because either alpha is 0
};

// Images of equal size. `scene_linear`: EXR values rather than display values.
Metrics compare_pictures(const io::Picture& a, const io::Picture& b, bool scene_linear);

// Eight times |A-B|, as display values.
io::Picture difference_picture(const io::Picture& a, const io::Picture& b, bool scene_linear);

// Mean structural similarity of luminance, 11x11 Gaussian window of sigma 1.5. Z. Wang et al., "Image Quality
// Assessment: From Error Visibility to Structural Similarity", 2004. Display values.
double structural_similarity(const io::Picture& a, const io::Picture& b, const std::vector<std::uint8_t>& counted);

// Mean FLIP of display values at 67 pixels per degree. P. Andersson et al., "FLIP: A Difference Evaluator for
// Alternating Images", 2020.
double flip(const io::Picture& a, const io::Picture& b, const std::vector<std::uint8_t>& counted);

} // namespace sunfleck::command_line

#include "editor/command_line/metrics.h"

#include <algorithm>
#include <cmath>

namespace sunfleck::command_line {
namespace {

// Tone-maps scene-linear values by x / (x + m), which is monotonic and needs no exposure.
io::Picture to_display(const io::Picture& picture, double mean) {
    io::Picture result = picture;
    const float m = float(std::max(mean, 1e-12));
    for (vec4& pixel : result.pixels)
        for (int c = 0; c < 3; ++c)
            pixel[c] = std::max(pixel[c], 0.0f) / (std::max(pixel[c], 0.0f) + m);
    return result;
}

double mean_length(const io::Picture& picture, const std::vector<std::uint8_t>& counted) {
    double sum = 0;
    std::size_t pixels = 0;
    for (std::size_t i = 0; i < picture.pixels.size(); ++i)
        if (counted[i]) {
            sum += double(glm::length(vec3(picture.pixels[i])));
            ++pixels;
        }
    return pixels > 0 ? sum / double(pixels) : 0.0;
}

std::vector<std::uint8_t> counted_pixels(const io::Picture& a, const io::Picture& b) {
    std::vector<std::uint8_t> counted(a.pixels.size());
    for (std::size_t i = 0; i < counted.size(); ++i)
        counted[i] = a.pixels[i].w != 0.0f && b.pixels[i].w != 0.0f;
    return counted;
}

void add_channel(Metrics& m, double a, double b) {
    const double error = std::abs(a - b);
    m.mean_a += a;
    m.mean_b += b;
    m.mean_absolute_error += error;
    m.maximum_error = std::max(m.maximum_error, error);
}

// The metrics that are means over pixels; `mean` is the mean length of B's pixels.
Metrics mean_errors(const io::Picture& a, const io::Picture& b, const std::vector<std::uint8_t>& counted, double mean,
                    bool scene_linear) {
    Metrics m;
    double squares = 0, relative = 0, peak = scene_linear ? 0.0 : 1.0;
    for (std::size_t i = 0; i < counted.size(); ++i) {
        if (!counted[i]) {
            ++m.left_out;
            continue;
        }
        ++m.pixels;
        double pixel_squares = 0, reference_squares = 0;
        for (int c = 0; c < 3; ++c) {
            const double va = double(a.pixels[i][c]), vb = double(b.pixels[i][c]), d = va - vb;
            add_channel(m, va, vb);
            pixel_squares += d * d;
            reference_squares += vb * vb;
            peak = std::max(peak, vb);
        }
        squares += pixel_squares;
        const double scale = reference_squares + 0.01 * mean * mean;
        relative += scale > 0 ? pixel_squares / scale : 0.0;
    }
    if (m.pixels == 0)
        return m;
    const double values = double(m.pixels) * 3.0;
    m.mean_a /= values;
    m.mean_b /= values;
    m.mean_absolute_error /= values;
    m.root_mean_square_error = std::sqrt(squares / values);
    m.relative_mean_square_error = relative / double(m.pixels);
    m.peak_signal_to_noise = squares > 0 ? std::min(999.0, 20.0 * std::log10(peak / m.root_mean_square_error)) : 999.0;
    return m;
}

} // namespace

Metrics compare_pictures(const io::Picture& a, const io::Picture& b, bool scene_linear) {
    const std::vector<std::uint8_t> counted = counted_pixels(a, b);
    const double mean = mean_length(b, counted);
    Metrics m = mean_errors(a, b, counted, mean, scene_linear);
    if (m.pixels == 0)
        return m;
    const io::Picture display_a = scene_linear ? to_display(a, mean) : a;
    const io::Picture display_b = scene_linear ? to_display(b, mean) : b;
    m.structural_similarity = structural_similarity(display_a, display_b, counted);
    m.flip = flip(display_a, display_b, counted);
    return m;
}

io::Picture difference_picture(const io::Picture& a, const io::Picture& b, bool scene_linear) {
    const std::vector<std::uint8_t> counted = counted_pixels(a, b);
    const double mean = mean_length(b, counted);
    const io::Picture display_a = scene_linear ? to_display(a, mean) : a;
    const io::Picture display_b = scene_linear ? to_display(b, mean) : b;
    io::Picture result = a;
    for (std::size_t i = 0; i < counted.size(); ++i)
        result.pixels[i] = counted[i]
                               ? vec4(8.0f * glm::abs(vec3(display_a.pixels[i]) - vec3(display_b.pixels[i])), 1.0f)
                               : vec4(0.0f, 0.0f, 0.0f, 1.0f);
    return result;
}

} // namespace sunfleck::command_line

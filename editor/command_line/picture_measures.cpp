#include "editor/command_line/picture_measures.h"

#include <algorithm>
#include <cmath>

namespace sunfleck::command_line {
namespace {

constexpr int block_side = 16;

// Values of a picture's pixels; beyond the border the nearest one's.
struct LuminanceImage {
    int width = 0, height = 0;
    std::vector<float> values;

    std::size_t place(int x, int y) const { return std::size_t(y) * std::size_t(width) + std::size_t(x); }
    float at(int x, int y) const { return values[place(std::clamp(x, 0, width - 1), std::clamp(y, 0, height - 1))]; }
};

LuminanceImage luminance_of(const io::Picture& picture) {
    LuminanceImage plane{int(picture.width), int(picture.height), {}};
    plane.values.reserve(picture.pixels.size());
    for (const vec4& pixel : picture.pixels)
        plane.values.push_back(luminance(vec3(pixel)));
    return plane;
}

// Largest difference from a pixel to its four neighbours.
LuminanceImage steepness(const LuminanceImage& plane) {
    LuminanceImage result = plane;
    for (int y = 0; y < plane.height; ++y)
        for (int x = 0; x < plane.width; ++x) {
            const float value = plane.at(x, y);
            result.values[plane.place(x, y)] =
                std::max({std::abs(value - plane.at(x + 1, y)), std::abs(value - plane.at(x - 1, y)),
                          std::abs(value - plane.at(x, y + 1)), std::abs(value - plane.at(x, y - 1))});
        }
    return result;
}

// The largest value within `reach` pixels.
LuminanceImage largest_near(const LuminanceImage& plane, int reach) {
    LuminanceImage across = plane, result = plane;
    const auto spread = [&](const LuminanceImage& from, LuminanceImage& to, int dx, int dy) {
        for (int y = 0; y < plane.height; ++y)
            for (int x = 0; x < plane.width; ++x) {
                float most = from.at(x, y);
                for (int k = -reach; k <= reach; ++k)
                    most = std::max(most, from.at(x + k * dx, y + k * dy));
                to.values[plane.place(x, y)] = most;
            }
    };
    spread(plane, across, 1, 0);
    spread(across, result, 0, 1);
    return result;
}

// 1 at the steepest twentieth of the pixels (and those as steep), else 0; none where all is flat.
LuminanceImage edges_of(const LuminanceImage& plane) {
    LuminanceImage steep = steepness(plane);
    std::vector<float> sorted = steep.values;
    const auto limit = sorted.end() - std::ptrdiff_t(std::max<std::size_t>(sorted.size() / 20, 1));
    std::nth_element(sorted.begin(), limit, sorted.end());
    for (float& value : steep.values)
        value = value >= *limit && value > 0.0f ? 1.0f : 0.0f;
    return steep;
}

// Less the mean of each block.
LuminanceImage without_block_means(LuminanceImage plane) {
    for (int top = 0; top < plane.height; top += block_side)
        for (int left = 0; left < plane.width; left += block_side) {
            const int bottom = std::min(top + block_side, plane.height);
            const int right = std::min(left + block_side, plane.width);
            double sum = 0.0;
            for (int y = top; y < bottom; ++y)
                for (int x = left; x < right; ++x)
                    sum += double(plane.at(x, y));
            const float mean = float(sum / double((bottom - top) * (right - left)));
            for (int y = top; y < bottom; ++y)
                for (int x = left; x < right; ++x)
                    plane.values[plane.place(x, y)] -= mean;
        }
    return plane;
}

} // namespace

io::Picture box_filtered(const io::Picture& picture, std::uint32_t side) {
    io::Picture result{picture.width / side, picture.height / side, {}};
    result.pixels.reserve(std::size_t(result.width) * result.height);
    for (std::uint32_t y = 0; y < result.height; ++y)
        for (std::uint32_t x = 0; x < result.width; ++x) {
            vec4 sum(0.0f);
            for (std::uint32_t i = 0; i < side * side; ++i)
                sum += picture.pixels[std::size_t(y * side + i / side) * picture.width + x * side + i % side];
            result.pixels.push_back(sum / float(side * side));
        }
    return result;
}

double edge_error(const io::Picture& picture, const io::Picture& reference) {
    const LuminanceImage truth = luminance_of(reference);
    const LuminanceImage near = largest_near(edges_of(truth), 2);
    const LuminanceImage a = without_block_means(luminance_of(picture)), b = without_block_means(truth);
    double sum = 0.0, count = 0.0;
    for (std::size_t i = 0; i < near.values.size(); ++i)
        if (near.values[i] > 0.0f) {
            sum += double(std::abs(a.values[i] - b.values[i]));
            count += 1.0;
        }
    return count > 0.0 ? sum / count : 0.0;
}

double stain_share(const io::Picture& picture, const io::Picture& reference) {
    const LuminanceImage steep = steepness(luminance_of(picture));
    const LuminanceImage truth = largest_near(steepness(luminance_of(reference)), 3);
    std::size_t stains = 0;
    for (std::size_t i = 0; i < steep.values.size(); ++i)
        stains += steep.values[i] > 3.0f / 255.0f && truth.values[i] < 1.0f / 255.0f;
    return double(stains) / double(steep.values.size());
}

double crawl(std::span<const io::Picture> frames, std::span<const io::Picture> references) {
    double wrong = 0.0, right = 0.0;
    for (std::size_t k = 0; k + 1 < frames.size(); ++k) {
        const LuminanceImage a = luminance_of(frames[k]), next = luminance_of(frames[k + 1]);
        const LuminanceImage r = luminance_of(references[k]), r_next = luminance_of(references[k + 1]);
        for (std::size_t i = 0; i < a.values.size(); ++i) {
            const float change = r_next.values[i] - r.values[i];
            wrong += double(std::abs(next.values[i] - a.values[i] - change));
            right += double(std::abs(change));
        }
    }
    return right > 0.0 ? wrong / right : 0.0;
}

} // namespace sunfleck::command_line

#include "gi_module/light_sampling/importance_warping.h"

#include <algorithm>
#include <bit>
#include <cassert>

namespace sunfleck::gi {
namespace {

constexpr float below_one = 0x1.fffffep-1f;

// Share of the first of two halves; where there is nothing, points stay where they are.
float share(float first, float second) {
    return first + second > 0.0f ? first / (first + second) : 0.5f;
}

// Eq. 5 and 6: moves the border of the halves from `ratio` to the middle, then zooms into the half. Returns which.
std::uint32_t warp_axis(float ratio, float& place, float& weight) {
    const bool second = place >= ratio;
    const float part = second ? 1.0f - ratio : ratio;
    place = std::clamp((place - (second ? ratio : 0.0f)) / part, 0.0f, below_one);
    weight /= 2.0f * part;
    return second;
}

} // namespace

ImportanceMap::ImportanceMap(std::span<const float> values, std::uint32_t side) {
    assert(std::has_single_bit(side) && values.size() == std::size_t(side) * side);
    levels_.resize(std::size_t(std::bit_width(side)));
    levels_.back().assign(values.begin(), values.end());
    for (std::size_t level = levels_.size() - 1; level-- > 0;) {
        const std::vector<float>& fine = levels_[level + 1];
        const std::size_t half = std::size_t(1) << level, row = 2 * half;
        levels_[level].resize(half * half);
        for (std::size_t y = 0; y < half; ++y)
            for (std::size_t x = 0; x < half; ++x) {
                const float* at = &fine[2 * y * row + 2 * x];
                levels_[level][y * half + x] = (at[0] + at[1]) + (at[row] + at[row + 1]);
            }
    }
}

WarpedPoint ImportanceMap::warp(vec2 point, WarpMethod method, std::uint32_t levels) const {
    WarpedPoint result{point, 1.0f};
    std::uint32_t x = 0, y = 0;
    for (std::uint32_t level = 1; level <= levels; ++level) {
        const float top_left = sum(level, 2 * x, 2 * y), top_right = sum(level, 2 * x + 1, 2 * y),
                    bottom_left = sum(level, 2 * x, 2 * y + 1), bottom_right = sum(level, 2 * x + 1, 2 * y + 1);
        const std::uint32_t row =
            warp_axis(share(top_left + top_right, bottom_left + bottom_right), result.place.y, result.weight);
        float left = top_left + bottom_left, right = top_right + bottom_right;
        if (method == WarpMethod::a) {
            left = row == 0 ? top_left : bottom_left;
            right = row == 0 ? top_right : bottom_right;
        }
        const std::uint32_t column = warp_axis(share(left, right), result.place.x, result.weight);
        x = 2 * x + column;
        y = 2 * y + row;
    }
    const float cell = 1.0f / float(1u << levels);
    result.place = glm::min((vec2(float(x), float(y)) + result.place) * cell, vec2(below_one));
    return result;
}

} // namespace sunfleck::gi

// Importance warping: sample points in the unit square are moved, level by level, to where a map of importances is
// large (P. Clarberg et al., "Wavelet Importance Sampling", SIGGRAPH 2005; C. Dachsbacher and M. Stamminger, "Splatting
// Indirect Illumination", I3D 2006, eq. 4 to 6). No iteration, no search, and neighbours stay neighbours.
#pragma once

#include "engine/core/maths.h"

#include <cstdint>
#include <span>
#include <vector>

namespace sunfleck::gi {

// a: the two halves of a row are weighed on their own; the density is that of the map at the finest level used.
// b: for all rows alike, which is faster; the density is a product of marginals at each level.
enum class WarpMethod : std::uint32_t { a, b };

struct WarpedPoint {
    vec2 place{0.0f};    // in [0, 1)^2; x along rows
    float weight = 1.0f; // 1 / density
};

class ImportanceMap {
public:
    ImportanceMap() = default;
    // `values`: side x side, row after row; none negative or not finite. `side`: a power of two.
    ImportanceMap(std::span<const float> values, std::uint32_t side);

    std::uint32_t levels() const { return std::uint32_t(levels_.size()) - 1; }
    float total() const { return levels_.empty() ? 0.0f : levels_.front().front(); }
    // Those that it was made of.
    std::span<const float> values() const { return levels_.back(); }
    // Sum of the values in a cell of 2^level x 2^level.
    float sum(std::uint32_t level, std::uint32_t x, std::uint32_t y) const {
        return levels_[level][(std::size_t(y) << level) + x];
    }
    // `point`: in [0, 1)^2. `levels`: at most levels().
    WarpedPoint warp(vec2 point, WarpMethod method, std::uint32_t levels) const;

private:
    std::vector<std::vector<float>> levels_; // by level: sums, 2^level a side
};

} // namespace sunfleck::gi

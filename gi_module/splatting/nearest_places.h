// The places that are nearest to a point, among a few thousand on surfaces: a grid in space.
#pragma once

#include "engine/core/maths.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace sunfleck::gi {

// Distance is that of positions and of normals scaled to a length.
struct Place {
    vec3 position{0.0f};
    vec3 normal{0.0f};     // times that length
    float handicap = 0.0f; // added to its squared distances, m2; not negative
};

inline float squared_distance(const Place& a, const Place& b) {
    const vec3 d = a.position - b.position, n = a.normal - b.normal;
    return glm::dot(d, d) + glm::dot(n, n);
}

// Of a point, those that share it: shares fall to zero where a place is farther than the nearest by half the squared
// distance of the second, so that they change smoothly as the point moves.
struct NearestPlaces {
    static constexpr std::size_t most = 6;
    std::uint32_t count = 0;
    std::array<std::uint32_t, most> index{}; // the nearest first
    std::array<float, most> share{};
    float first = 0.0f, second = 0.0f; // squared distances, m2, with handicaps
};

class PlaceGrid {
public:
    // `cell`: side of a cell, m; larger where the grid would have too many.
    void build(std::span<const Place> places, float cell);
    // Of at least two places; of one, `second` is as far as floats go.
    NearestPlaces find(const Place& point) const;

private:
    glm::ivec3 cell_of(vec3 position) const;
    template <typename F>
    void visit_ring(glm::ivec3 centre, int ring, const F& visit) const;

    std::span<const Place> places_;
    vec3 low_{0.0f};
    float cell_ = 1.0f;
    glm::ivec3 size_{1};
    std::vector<std::uint32_t> starts_, order_;
};

} // namespace sunfleck::gi

#include "gi_module/splatting/nearest_places.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sunfleck::gi {
namespace {

constexpr int most_cells = 48; // along an axis

// Those found so far, by distance.
struct Found {
    struct Entry {
        float distance;
        std::uint32_t index;
    };
    std::array<Entry, NearestPlaces::most> entries;
    std::size_t count = 0;

    void add(float distance, std::uint32_t index) {
        if (count == entries.size() && distance >= entries.back().distance)
            return;
        std::size_t at = count < entries.size() ? count++ : count - 1;
        for (; at > 0 && (entries[at - 1].distance > distance ||
                          (entries[at - 1].distance == distance && entries[at - 1].index > index));
             --at)
            entries[at] = entries[at - 1];
        entries[at] = {distance, index};
    }
    float second() const { return count > 1 ? entries[1].distance : std::numeric_limits<float>::infinity(); }
    // What is farther than this shares nothing.
    float reach() const { return count > 1 ? entries[0].distance + 0.5f * second() : second(); }
};

} // namespace

glm::ivec3 PlaceGrid::cell_of(vec3 position) const {
    return glm::clamp(glm::ivec3(glm::floor((position - low_) / cell_)), glm::ivec3(0), size_ - 1);
}

void PlaceGrid::build(std::span<const Place> places, float cell) {
    places_ = places;
    vec3 high(-1e30f);
    low_ = vec3(1e30f);
    for (const Place& place : places) {
        low_ = glm::min(low_, place.position);
        high = glm::max(high, place.position);
    }
    const vec3 extent = places.empty() ? vec3(0.0f) : high - low_;
    cell_ = std::max(
        {cell, std::max({extent.x, extent.y, extent.z}) / float(most_cells), std::numeric_limits<float>::min()});
    size_ = glm::ivec3(glm::floor(extent / cell_)) + 1;
    starts_.assign(std::size_t(size_.x) * size_.y * size_.z + 1, 0);
    order_.resize(places.size());
    const auto index = [&](const Place& place) {
        const glm::ivec3 c = cell_of(place.position);
        return (std::size_t(c.z) * size_.y + c.y) * size_.x + c.x;
    };
    for (const Place& place : places)
        ++starts_[index(place) + 1];
    for (std::size_t i = 1; i < starts_.size(); ++i)
        starts_[i] += starts_[i - 1];
    std::vector<std::uint32_t> next(starts_.begin(), starts_.end() - 1);
    for (std::size_t i = 0; i < places.size(); ++i)
        order_[next[index(places[i])]++] = std::uint32_t(i);
}

// The cells at a distance of `ring` cells along the farthest axis.
template <typename F>
void PlaceGrid::visit_ring(glm::ivec3 centre, int ring, const F& visit) const {
    const glm::ivec3 low = glm::max(centre - ring, glm::ivec3(0)), high = glm::min(centre + ring, size_ - 1);
    for (int z = low.z; z <= high.z; ++z)
        for (int y = low.y; y <= high.y; ++y) {
            const bool shell = std::abs(z - centre.z) == ring || std::abs(y - centre.y) == ring;
            const std::size_t row = (std::size_t(z) * size_.y + y) * size_.x;
            for (int x = low.x; x <= high.x; ++x) {
                if (!shell && std::abs(x - centre.x) != ring)
                    continue;
                for (std::uint32_t k = starts_[row + x]; k < starts_[row + x + 1]; ++k)
                    visit(order_[k]);
            }
        }
}

NearestPlaces PlaceGrid::find(const Place& point) const {
    NearestPlaces result;
    Found found;
    const glm::ivec3 centre = cell_of(point.position);
    const int last = std::max({size_.x, size_.y, size_.z});
    // What lies beyond a ring is at least a ring's width less the place in the own cell away.
    for (int ring = 0; ring <= last; ++ring) {
        const float nearest = std::max(float(ring - 1), 0.0f) * cell_;
        if (nearest * nearest > found.reach())
            break;
        visit_ring(centre, ring,
                   [&](std::uint32_t i) { found.add(squared_distance(point, places_[i]) + places_[i].handicap, i); });
    }
    if (found.count == 0)
        return result;
    result.first = found.entries[0].distance;
    result.second = std::min(found.second(), std::numeric_limits<float>::max());
    float total = 0.0f;
    for (std::size_t k = 0; k < found.count; ++k) {
        const float excess = found.entries[k].distance - result.first;
        const float share = result.second > 0.0f ? 1.0f - 2.0f * excess / result.second : (k == 0 ? 1.0f : 0.0f);
        if (share <= 0.0f)
            break;
        result.index[result.count] = found.entries[k].index;
        result.share[result.count++] = share * share;
        total += share * share;
    }
    for (std::size_t k = 0; k < result.count; ++k)
        result.share[k] /= total;
    return result;
}

} // namespace sunfleck::gi

// Which texels of a shadow map a box may cover; conservative.
#pragma once

#include "engine/core/maths.h"
#include "gi_module/transport/light_row.h"

#include <span>
#include <vector>

namespace sunfleck::gi {

// Texels from `low` to `high`, exclusive; empty if there are none.
struct MapArea {
    glm::uvec2 low{0xffffffffu}, high{0};
    bool empty() const { return low.x >= high.x || low.y >= high.y; }
    bool overlaps(const MapArea& other) const;
    static MapArea all(std::uint32_t resolution) { return {glm::uvec2(0), glm::uvec2(resolution)}; }
};

// Disjoint areas of one map: overlapping ones are merged.
class MapAreas {
public:
    void add(MapArea area);
    void add(const MapAreas& other);
    std::span<const MapArea> areas() const { return areas_; }

private:
    std::vector<MapArea> areas_;
};

// Area that a box (world space) may cover in the map of a light, on the faces whose bit is set (octahedral_map.h); one
// texel larger on each side and aligned to even columns, which copies need. The whole map if the box reaches behind a
// face's projection centre.
MapArea covered_area(const shared::LightRow& light, std::uint32_t light_class, std::uint32_t faces,
                     const Bounds& bounds, std::uint32_t resolution);

} // namespace sunfleck::gi

// Which texels of a shadow map a box can cover.
#pragma once

#include "engine/core/maths.h"
#include "gi_module/transport/light_row.h"

#include <span>
#include <vector>

namespace sunfleck::gi {

// Texels from `low` up to, not including, `high`; empty if there are none.
struct MapArea {
    glm::uvec2 low{0xffffffffu}, high{0};
    bool empty() const { return low.x >= high.x || low.y >= high.y; }
    bool meets(const MapArea& other) const;
    static MapArea all(std::uint32_t resolution) { return {glm::uvec2(0), glm::uvec2(resolution)}; }
};

// Areas of one map, none of which overlap: those that would are joined.
class MapAreas {
public:
    void add(MapArea area);
    void add(const MapAreas& other);
    std::span<const MapArea> areas() const { return areas_; }

private:
    std::vector<MapArea> areas_;
};

// Of a box (world space) in the map of a light, through the faces whose bit is set (octahedral_map.h); a texel wider on
// each side, and on even columns, as copies need. Everything if the box reaches behind a face's projection.
MapArea covered_area(const shared::LightRow& light, std::uint32_t light_class, std::uint32_t faces,
                     const Bounds& bounds, std::uint32_t resolution);

} // namespace sunfleck::gi

// Which texels of a shadow map a box may cover; conservative.
#pragma once

#include "engine/core/maths.h"
#include "gi_module/transport/light_row.h"

#include <span>
#include <vector>

namespace sunfleck::gi {

// The square of a map that is drawn, if not all of it: so that a part can have more texels.
struct MapTile {
    vec2 centre{0.0f};  // in map coordinates, [-1, 1]^2
    float scale = 1.0f; // 1 / half its side

    bool is_whole_map() const { return scale == 1.0f; }
};

// A bit per face of octahedral_map.h: set if the face may have a part in the tile. Only maps of point lights are told
// apart.
std::uint32_t faces_in_tile(std::uint32_t light_class, const MapTile& tile);

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

// Area that a box (world space) may cover in the map of a light, or in a tile of it, on the faces whose bit is set
// (octahedral_map.h); one texel larger on each side and aligned to even columns, which copies need. The whole map if
// the box reaches behind a face's projection centre.
MapArea covered_area(const shared::LightRow& light, std::uint32_t light_class, std::uint32_t faces,
                     const Bounds& bounds, std::uint32_t resolution, const MapTile& tile = {});

} // namespace sunfleck::gi

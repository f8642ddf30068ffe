// Per-instance data that projects the vertices of an occluder to a face of a shadow map.
#pragma once

#include "engine/scene/instance_shared.h"
#include "gi_module/shadows/map_area.h"
#include "gi_module/shadows/shadow_map_shared.h"

namespace sunfleck::gi {

// What of which map is drawn, and where.
struct MapFace {
    std::uint32_t layer = 0;        // of the staging image
    std::uint32_t face = 0;         // see octahedral_map.h; 0 for directional lights
    std::uint32_t resolution = 256; // texels along a side of what is drawn
    MapTile tile{};
};

// `row`: instance row of `occluder`.
shared::ShadowJob make_shadow_job(const shared::LightRow& light, std::uint32_t light_class, const MapFace& place,
                                  const shared::DrawConstants& occluder, std::uint32_t row);

} // namespace sunfleck::gi

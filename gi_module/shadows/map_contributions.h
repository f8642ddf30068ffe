// How much each stale shadow map matters to the picture: the scheduler's first priority.
#pragma once

#include "engine/scene/gpu_scene.h"
#include "gi_module/transport/light_row_shared.h"
#include "gi_module/visibility/visibility_database.h"

#include <span>

namespace sunfleck::gi {

// By sample, in arbitrary units: the sample's unshadowed irradiance on all visible nodes that movers shadow from it and
// on the movers themselves, each weighted by its approximate share of the picture. That is how much of the picture's
// light the movers' part of the map decides. Only for samples whose `requested` is not 0; 0 for the others.
// `rows`: of the samples. `view_projection`: world to clip, reverse depth without a far plane.
std::vector<float> map_contributions(const VisibilityDatabase& database, std::span<const LightSample> samples,
                                     std::span<const shared::LightRow> rows, std::span<const scene::DrawItem> draws,
                                     const mat4& view_projection, std::span<const std::uint8_t> requested);

} // namespace sunfleck::gi

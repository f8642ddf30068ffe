// What stale shadow maps cost the picture: the scheduler's first priority.
#pragma once

#include "engine/scene/gpu_scene.h"
#include "gi_module/transport/light_row_shared.h"
#include "gi_module/visibility/visibility_database.h"

#include <span>

namespace sunfleck::gi {

// By sample, in arbitrary units: the unshadowed irradiance of the sample on all nodes that movers shadow from it and
// that the view may show, each times about its share of the picture; and on the movers themselves. That is how much of
// the picture's light the movers' part of the map decides. 0 for samples that are not `wanted`.
// `rows`: of the samples. `view_projection`: world to clip, reverse depth without a far plane.
std::vector<float> map_contributions(const VisibilityDatabase& database, std::span<const LightSample> samples,
                                     std::span<const shared::LightRow> rows, std::span<const scene::DrawItem> draws,
                                     const mat4& view_projection, std::span<const std::uint8_t> wanted);

} // namespace sunfleck::gi

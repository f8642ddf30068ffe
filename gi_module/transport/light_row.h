// Light samples (VPLs) as shaders read them: from sample to row.
#pragma once

#include "gi_module/transport/light_row_shared.h"
#include "gi_module/transport/light_sample.h"

namespace sunfleck::gi {

std::uint32_t light_class(SampleKind kind);

// Whether shadow map look-ups of a class are filtered (percentage-closer): if requested, and always for point, spot and
// directional lights, whose light is a single sample, so that every texel of the shadow's edge would be visible.
bool filters_maps(bool filter_requested, std::uint32_t light_class);

// `geometry_bound`: see transport/clamping.h. `scene`: box around all geometry; the map of a directional sample covers
// its bounding sphere.
shared::LightRow make_light_row(const LightSample& sample, std::uint32_t slot, float geometry_bound,
                                const Bounds& scene);

} // namespace sunfleck::gi

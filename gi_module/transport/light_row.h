#pragma once

#include "gi_module/transport/light_row_shared.h"
#include "gi_module/transport/light_sample.h"

namespace sunfleck::gi {

std::uint32_t light_class(SampleKind kind);

// Whether map look-ups of a class blend neighbouring texels: where it is wished, and always for point and spot lights,
// whose light is one sample, so that each step of its shadow's edge is seen.
bool filters_maps(bool wished, std::uint32_t light_class);

// The numbers a shader needs. `geometry_bound`: see transport/clamping.h. `scene`: box around all geometry; the map of
// a directional sample covers its bounding sphere.
shared::LightRow make_light_row(const LightSample& sample, std::uint32_t slot, float geometry_bound,
                                const Bounds& scene);

} // namespace sunfleck::gi

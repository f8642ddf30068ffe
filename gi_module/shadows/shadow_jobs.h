// Per-instance data that projects the vertices of an occluder to a face of a shadow map.
#pragma once

#include "engine/scene/instance_shared.h"
#include "gi_module/shadows/shadow_map_shared.h"

namespace sunfleck::gi {

// `layer`: of the staging image. `face`: see octahedral_map.h; 0 for directional lights. `row`: instance row of
// `occluder`.
shared::ShadowJob make_shadow_job(const shared::LightRow& light, std::uint32_t light_class, std::uint32_t layer,
                                  std::uint32_t face, const shared::DrawConstants& occluder, std::uint32_t row);

} // namespace sunfleck::gi

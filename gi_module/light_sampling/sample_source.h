// How light samples (VPLs) are generated: the module's second list, next to that of techniques. A source makes the
// samples of static emitters from emitters and static geometry; those of dynamic emitters are dynamic_lights.h's.
#pragma once

#include "engine/raytrace/ray_scene.h"
#include "gi_module/light_sampling/emitters.h"
#include "gi_module/light_sampling/sampling_settings.h"

#include <functional>
#include <span>
#include <string_view>

namespace sunfleck::gi {

struct SampleSource {
    std::string_view name; // --source NAME
    std::string_view tooltip;
    // Exactly `request.lights` samples unless too little light meets a surface; a pure function of its arguments.
    // `progress`: called with the share that is done, by the calling thread. If it returns false, the work stops, and
    // what is returned is of no use.
    std::vector<LightSample> (*make)(const std::vector<Emitter>& emitters, const SampleRequest& request,
                                     const raytrace::RayScene& rays, const std::function<bool(float)>& progress);
};

// The first is the default.
std::span<const SampleSource> sample_sources();

} // namespace sunfleck::gi

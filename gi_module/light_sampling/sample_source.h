// Where light samples come from: the second list of the module, beside that of techniques. A source turns emitters and
// static geometry into the samples of emitters that stay; those of emitters that move are dynamic_lights.h's.
#pragma once

#include "engine/raytrace/ray_scene.h"
#include "gi_module/light_sampling/emitters.h"
#include "gi_module/light_sampling/sampling_settings.h"

#include <span>
#include <string_view>

namespace sunfleck::gi {

struct SampleSource {
    std::string_view name; // --source NAME
    std::string_view tooltip;
    // Exactly `request.lights` samples where there is light enough; a pure function of its arguments.
    std::vector<LightSample> (*make)(const std::vector<Emitter>& emitters, const SampleRequest& request,
                                     const raytrace::RayScene& rays);
};

// The first is the default.
std::span<const SampleSource> sample_sources();

} // namespace sunfleck::gi

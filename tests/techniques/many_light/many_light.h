// What tests see of the many-light system while it runs.
#pragma once

#include "gi_module/many_light/many_light_technique.h"
#include "tests/support/gpu_world.h"

namespace sunfleck::tests {

class ManyLightTest : public GpuTest {};

inline const gi::ManyLightTechnique& many_light_technique(gi::System& system) {
    return dynamic_cast<const gi::ManyLightTechnique&>(*system.technique("light_samples"));
}
inline const gi::ManyLight& many_light(gi::System& system) {
    return many_light_technique(system).lighting();
}
inline const gi::CurvedCharts& curved_charts(gi::System& system) {
    return many_light_technique(system).curved_charts();
}

} // namespace sunfleck::tests

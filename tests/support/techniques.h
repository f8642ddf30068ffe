// What tests see of single techniques of a running system.
#pragma once

#include "gi_module/brute_force/brute_force_technique.h"
#include "gi_module/many_light/many_light_technique.h"
#include "gi_module/system.h"

namespace sunfleck::tests {

inline const gi::ManyLightTechnique& many_light_technique(gi::System& system) {
    return dynamic_cast<const gi::ManyLightTechnique&>(*system.technique("light_samples"));
}
inline const gi::ManyLight& many_light(gi::System& system) {
    return many_light_technique(system).lighting();
}
inline const gi::CurvedCharts& curved_charts(gi::System& system) {
    return many_light_technique(system).curved_charts();
}
inline gi::BruteForce& brute_force_kernel(gi::System& system) {
    return dynamic_cast<gi::BruteForceTechnique&>(*system.technique("brute_force")).kernel();
}

} // namespace sunfleck::tests

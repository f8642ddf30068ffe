// A technique from outside of the module: the same irradiance everywhere, in place of reflected light. It is as small
// as a technique can be, and the tests of this folder are its only user: whatever they find of it (options, counters,
// views) follows from its entry alone.
#pragma once

#include "gi_module/technique.h"

namespace sunfleck::tests {

struct ConstantLightSettings {
    float constant_irradiance = 0.25f; // W/m2
    std::uint32_t constant_work = 0;   // turns at each pixel; 0: without the pass

    static const TypeDescription& description();
};

const gi::TechniqueEntry& constant_light();

} // namespace sunfleck::tests

// What a host that owns gpu::Timers hands on to gi::System::update.
#pragma once

#include "engine/gpu/timers.h"
#include "gi_module/system.h"

namespace sunfleck::gi {

// For ShadowSettings::map_milliseconds.
inline void set_measured_times(FrameInput& input, const gpu::FrameTimes& times) {
    input.measured_serial = times.serial;
    for (const char* pass : {"shadow maps", "shadow map copies"})
        if (const auto found = times.milliseconds.find(pass); found != times.milliseconds.end())
            input.measured_map_milliseconds += found->second;
}

} // namespace sunfleck::gi

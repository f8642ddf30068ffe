// What the quality presets stand for.
#pragma once

#include "game_demo/demo_settings.h"
#include "gi_module/settings.h"

namespace sunfleck::demo {

// Sets what the preset decides; `custom` changes nothing.
void apply_preset(DemoSettings& settings);
// The lighting of these settings.
gi::Settings lighting_of(const DemoSettings& settings);
// `software` on a CPU, `high` on a GPU.
Preset usual_preset(bool software_device);

} // namespace sunfleck::demo

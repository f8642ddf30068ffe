// The quality presets (viewer/quality.h) in the player's settings.
#pragma once

#include "game_demo/demo_settings.h"
#include "gi_module/settings.h"

namespace sunfleck::demo {

// Sets the fields that the preset determines; `custom` changes nothing.
void apply_preset(DemoSettings& settings);
// The lighting settings that correspond to `settings`.
gi::Settings lighting_of(const DemoSettings& settings);
// Light that is ready in a fraction of the time, for the first pictures of a level: of few samples, none of which
// refine.
DemoSettings first_light(DemoSettings settings);
// Whether this build has precomputed transfer for movers; a technique can be left out.
bool has_transfer();
// `software` on a CPU, `high` on a GPU.
Preset default_preset(bool software_device);

} // namespace sunfleck::demo

// The samples of each kind of sound, computed: tones that die away, and noise through filters.
#pragma once

#include "game_demo/game/heard.h"

namespace sunfleck::demo {

// At app::Sound::sample_rate, -1 to 1. Those that go on end where they begin, so that they repeat without a seam.
std::vector<float> clip_of(SoundKind kind);

} // namespace sunfleck::demo

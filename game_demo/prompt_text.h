// What the player is told in words.
#pragma once

#include "engine/simulation/simulation.h"
#include "game_demo/demo_settings.h"

namespace sunfleck::demo {

// What the button in the player's hands would do now: "E  take the lantern"; empty: nothing.
std::string prompt_text(const DemoSettings& settings, simulation::Interaction interaction, bool carries_lantern,
                        bool with_gamepad);

// What there is to do in a level that is a game, or in one that is not.
const char* help_text(bool is_game);

} // namespace sunfleck::demo

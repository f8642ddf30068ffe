// What is measured of the game in its window. Each function writes a JSON file that report.h reads.
#pragma once

#include "tests/bench/smoothness/driven_game.h"

namespace sunfleck::bench {

// Plays a room for so many seconds, or to the next one: time between presents, frames that took long and why.
Status measure_pacing(const GameStart& start, double seconds, const std::filesystem::path& output);
// At rest at the room's entry: from an event to the first changed pixel, so many times for looking and for walking.
Status measure_latency(const GameStart& start, unsigned samples, const std::filesystem::path& output);

} // namespace sunfleck::bench

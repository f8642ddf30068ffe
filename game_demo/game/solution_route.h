// What the solution does in each room.
#pragma once

#include "game_demo/game/solution.h"

namespace sunfleck::demo {

struct Solution::Task {
    enum Kind { walk, look, wait, press, until_open, until_down, until_up } kind;
    vec3 target{0.0f};
    std::uint32_t steps = 0; // duration of wait and press; limit of the others
    std::uint32_t button = 0;
    std::string name{}; // sensor, or lift

    bool must_happen() const { return kind != wait && kind != press && kind != look; }
};

// From the entry of the area of this name to the end; empty if there is no such area.
std::vector<Solution::Task> solution_from(const std::string& area);

} // namespace sunfleck::demo

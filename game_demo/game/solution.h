// Plays lantern_game to its end, room by room, as a person would who reads the hints: a closed loop that looks at where
// it stands and at what is open. It may begin in any room, at its entry with the lantern in hand.
#pragma once

#include "game_demo/game/game_world.h"

#include <string>

namespace sunfleck::demo {

class Solution {
public:
    // `world` must outlive it.
    explicit Solution(const GameWorld& world);
    // Whether there is one from where the person is.
    static bool exists(const GameWorld& world) { return Solution(world).problem().empty(); }
    ~Solution();
    Solution(const Solution&) = delete;
    Solution& operator=(const Solution&) = delete;

    // The next step's input; empty at the end.
    simulation::StepInput next();
    // The goal was reached, or the solution does not work: what it waits for did not happen.
    bool ended() const;
    // Empty, or what did not happen.
    const std::string& problem() const { return problem_; }
    // Begins with the room that the person is in, at its entry.
    void begin_here();

    struct Task;

private:
    bool perform(const Task& task, simulation::StepInput& input);
    bool walk(const Task& task, simulation::StepInput& input) const;
    std::string area_name() const;

    const GameWorld& world_;
    std::vector<Task> tasks_;
    std::size_t place_ = 0;
    std::uint32_t spent_ = 0; // steps spent on this task
    std::string problem_;
};

} // namespace sunfleck::demo

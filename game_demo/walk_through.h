// The built-in walk through the house, as a list of places to go to and to look at. A bot turns it into step inputs by
// watching the simulation; its input can be recorded and replayed without the bot.
#pragma once

#include "engine/simulation/simulation.h"

namespace sunfleck::demo {

class WalkThrough {
public:
    WalkThrough();
    // The next step's input; empty at the end.
    simulation::StepInput next(const simulation::Simulation& simulation);
    bool finished() const { return place_ >= tasks_.size(); }

    struct Task {
        enum Kind { walk, look, wait, press, ride } kind;
        vec3 target{0.0f};
        std::uint32_t steps = 0; // duration of wait; limit of the others
        std::uint32_t buttons = 0;
    };

private:
    // The input of the current step; true if the task is done.
    bool perform(const Task& task, const simulation::Simulation& simulation, simulation::StepInput& input) const;

    std::vector<Task> tasks_;
    std::size_t place_ = 0;
    std::uint32_t spent_ = 0; // steps spent on this task
};

} // namespace sunfleck::demo

// The recorded walk through the house, as its author thinks of it: where to go and where to look. A bot turns it into
// steps of input by watching the simulation; what it did can be recorded and replayed without it.
#pragma once

#include "engine/simulation/simulation.h"

namespace sunfleck::demo {

class WalkThrough {
public:
    WalkThrough();
    // The next step's input; standing still at the end.
    simulation::StepInput next(const simulation::Simulation& simulation);
    bool finished() const { return place_ >= tasks_.size(); }

private:
    struct Task {
        enum Kind { walk, look, wait, press, ride } kind;
        vec3 target{0.0f};
        std::uint32_t steps = 0; // wait; walk: gives up after so many
        std::uint32_t buttons = 0;
    };
    void walk(float x, float z, std::uint32_t buttons = 0);
    void look(float x, float y, float z);
    void wait(std::uint32_t steps);
    void press(std::uint32_t button);
    void ride(float height);
    simulation::StepInput turn_to(const simulation::Character& person, vec3 target, float& off) const;

    std::vector<Task> tasks_;
    std::size_t place_ = 0;
    std::uint32_t spent_ = 0; // steps on this task
};

} // namespace sunfleck::demo

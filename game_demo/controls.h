// From keys, pointer and gamepad to what a person does in a step.
#pragma once

#include "engine/simulation/input_recording.h"
#include "game_demo/demo_settings.h"

namespace sunfleck::demo {

class Controls {
public:
    // Takes in a poll's input; `seconds` since the last one. Without `playing`, everything is let go.
    void take(const app::InputState& input, const DemoSettings& settings, double seconds, bool playing);
    // What is done in the next step: all of the view's motion so far, and what is held down.
    simulation::StepInput next_step();
    // True once for each time that the action's key or button went down.
    bool pressed(const app::InputState& input, const DemoSettings& settings, Action action);

private:
    vec2 look_{0.0f}; // 1e-4 rad not yet handed on: left, up
    simulation::StepInput held_;
    std::uint32_t taps_ = 0; // buttons that went down and up again between steps
    std::uint32_t pad_before_ = 0, pad_now_ = 0;
};

} // namespace sunfleck::demo

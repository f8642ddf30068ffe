// Translates keyboard, mouse and gamepad input to the person's input per step.
#pragma once

#include "engine/simulation/input_recording.h"
#include "game_demo/demo_settings.h"

namespace sunfleck::demo {

class Controls {
public:
    // Accumulates a poll's input; `seconds` since the last one. If not `playing`, everything is released.
    void take(const app::InputState& input, const DemoSettings& settings, double seconds, bool playing);
    // What the pointer did since, in pixels: a view that is drawn need not wait for the next poll.
    void turn(vec2 pointer_motion, const DemoSettings& settings);
    // Input of the next step: all accumulated look motion, and the held keys.
    simulation::StepInput next_step();
    // Look motion that no step has taken yet, rad to the left and up.
    vec2 pending_look() const;
    // True once per press of the gamepad's button for indirect light.
    bool pad_pressed_indirect_light() const;
    // True once when the gamepad is gone with which the person played last. What it held is released.
    bool lost_gamepad() const { return lost_pad_; }
    // What the person played with last, so that prompts name what is in their hands.
    bool plays_with_gamepad() const { return plays_with_pad_; }

private:
    vec2 look_{0.0f}; // 1e-4 rad not yet consumed: left, up
    simulation::StepInput held_;
    std::uint32_t taps_ = 0; // buttons pressed and released between steps
    std::uint32_t pad_before_ = 0, pad_now_ = 0;
    std::uint32_t pad_of_menu_ = 0; // went down before the game went on: what took "Resume" uses nothing
    bool plays_with_pad_ = false, lost_pad_ = false;

    void watch_gamepad(const app::InputState& input);
};

} // namespace sunfleck::demo

#include "game_demo/controls.h"

#include <algorithm>
#include <cmath>

namespace sunfleck::demo {
namespace {

constexpr float pointer_speed = 22.0f;  // 1e-4 rad per pixel
constexpr float stick_speed = 26000.0f; // 1e-4 rad/s at full deflection
constexpr float key_speed = 15000.0f;   // 1e-4 rad/s: a quarter turn in a second
constexpr vec2 largest_turn(30000.0f);  // 1e-4 rad in a step
constexpr int pad_a = 0, pad_b = 1, pad_x = 2, pad_y = 3, pad_left_bumper = 4;

std::int32_t percent(float value) {
    return std::int32_t(std::lround(std::clamp(value, -1.0f, 1.0f) * 100.0f));
}

} // namespace

void Controls::take(const app::InputState& input, const DemoSettings& settings, double seconds, bool playing) {
    pad_before_ = pad_now_;
    pad_now_ = input.gamepad.buttons;
    watch_gamepad(input);
    pad_of_menu_ &= pad_now_;
    held_ = {};
    if (!playing) {
        pad_of_menu_ = pad_now_;
        look_ = vec2(0.0f);
        taps_ = 0;
        return;
    }
    const auto held = [&](Action action) { return input.down(settings.bindings[std::size_t(action)]); };
    const auto axis = [&](Action plus, Action minus) {
        return (held(plus) ? 1.0f : 0.0f) - (held(minus) ? 1.0f : 0.0f);
    };
    held_.forward = percent(axis(Action::forward, Action::back) - input.gamepad.left.y);
    held_.right = percent(axis(Action::right, Action::left) + input.gamepad.left.x);
    const auto button = [&](Action action, std::uint32_t bit, int pad) {
        if (held(action) || (input.gamepad.pressed(pad) && (pad_of_menu_ & (1u << pad)) == 0))
            held_.buttons |= bit;
        if (input.hit(settings.bindings[std::size_t(action)]))
            taps_ |= bit;
    };
    button(Action::run, simulation::button_run, pad_left_bumper);
    button(Action::crouch, simulation::button_crouch, pad_b);
    button(Action::use, simulation::button_use, pad_a);
    button(Action::put_down, simulation::button_put_down, pad_x);
    const float upwards = settings.invert_look ? 1.0f : -1.0f;
    const float bent = glm::length(input.gamepad.right); // finer control near the centre
    look_ += settings.sensitivity * key_speed * float(seconds) *
             vec2(axis(Action::look_left, Action::look_right), axis(Action::look_up, Action::look_down));
    turn(input.mouse_motion, settings);
    look_ += settings.sensitivity * stick_speed * float(seconds) * bent *
             vec2(-input.gamepad.right.x, upwards * input.gamepad.right.y);
}

void Controls::turn(vec2 pointer_motion, const DemoSettings& settings) {
    const float upwards = settings.invert_look ? 1.0f : -1.0f;
    look_ += settings.sensitivity * pointer_speed * vec2(-pointer_motion.x, upwards * pointer_motion.y);
}

void Controls::watch_gamepad(const app::InputState& input) {
    const app::Gamepad& pad = input.gamepad;
    lost_pad_ = plays_with_pad_ && !pad.present;
    if (!pad.present || !input.went_down.empty() || input.mouse_motion != vec2(0.0f))
        plays_with_pad_ = false;
    else if (pad.buttons != 0 || pad.left != vec2(0.0f) || pad.right != vec2(0.0f))
        plays_with_pad_ = true;
}

simulation::StepInput Controls::next_step() {
    simulation::StepInput step = held_;
    step.buttons |= taps_;
    taps_ = 0;
    const vec2 look = glm::clamp(look_, -largest_turn, largest_turn);
    step.turn = std::int32_t(look.x);
    step.look_up = std::int32_t(look.y);
    look_ -= vec2(float(step.turn), float(step.look_up));
    return step;
}

vec2 Controls::pending_look() const {
    return simulation::look_unit * glm::clamp(look_, -largest_turn, largest_turn);
}

bool Controls::pad_pressed_indirect_light() const {
    return (pad_now_ & ~pad_before_ & (1u << pad_y)) != 0;
}

} // namespace sunfleck::demo

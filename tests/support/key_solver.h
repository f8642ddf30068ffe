// Plays the game's solution as a person does: by what the window's game says of itself (game_demo/state_file.h), and by
// keys and pointer, which take a frame or two to show.
#pragma once

#include "game_demo/game/saved_game.h"
#include "tests/game/played_game.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

namespace sunfleck::tests {

// What a person's hands do next.
struct HandMotion {
    std::int32_t right = 0, down = 0; // of the pointer, pixels
    bool walks = false, slowly = false, uses = false;
};

class KeySolver {
public:
    static constexpr float pixel = 22e-4f; // rad that the view turns for a pixel, at the usual sensitivity

    KeySolver() : solution_(*copy_.world) {}
    KeySolver(const KeySolver&) = delete;
    KeySolver& operator=(const KeySolver&) = delete;

    // After each change of the game's state. None: no step was taken since.
    std::optional<HandMotion> next(const nlohmann::json& state) {
        const auto steps = state.value("steps", std::uint64_t(0));
        if (steps == steps_ || !demo::load_game(*copy_.world, "lantern_game", state.value("saved", std::string())))
            return std::nullopt;
        const bool first = steps_ == 0;
        if (first)
            solution_.begin_here();
        // A stall must not use up the time that the solution gives itself.
        const std::uint64_t passed = first ? 1 : std::min<std::uint64_t>(steps - steps_, 30);
        steps_ = steps;
        simulation::StepInput input;
        std::uint32_t buttons = 0;
        for (std::uint64_t i = 0; i < passed; ++i) {
            input = solution_.next();
            buttons |= input.buttons;
        }
        HandMotion motion;
        motion.walks = input.forward > 0;
        motion.slowly = motion.walks && input.forward < 50;
        motion.uses = (buttons & simulation::button_use) != 0;
        turn(input, float(passed), motion);
        return motion;
    }
    // Empty, or why the solution does not work.
    const std::string& problem() const { return solution_.problem(); }
    const demo::GameWorld& world() const { return *copy_.world; }

private:
    // The solution's turn of a step, for a frame's steps, less what was asked for and does not show yet: else each
    // frame would ask once more, and the view would swing.
    void turn(const simulation::StepInput& input, float passed, HandMotion& motion) {
        const simulation::Character& person = copy_.world->simulation().player();
        const vec2 shows(person.yaw(), person.pitch());
        if (shows_)
            waiting_ -= vec2(std::remainder(shows.x - shows_->x, 2.0f * pi), shows.y - shows_->y);
        waiting_ *= 0.9f; // what was lost at the limits, or to a menu, is forgotten
        shows_ = shows;
        const vec2 turn = simulation::look_unit * passed * vec2(float(input.turn), float(input.look_up)) - waiting_;
        motion.right = -std::int32_t(std::lround(turn.x / pixel));
        motion.down = -std::int32_t(std::lround(turn.y / pixel));
        waiting_ += pixel * vec2(float(-motion.right), float(-motion.down));
    }

    Played copy_;
    demo::Solution solution_;
    std::uint64_t steps_ = 0;
    std::optional<vec2> shows_;
    vec2 waiting_{0.0f};
};

} // namespace sunfleck::tests

#include "game_demo/walk_through.h"

#include "game_demo/game/turning.h"

#include <iterator>

namespace sunfleck::demo {
namespace {

constexpr float near_enough = 0.25f;      // m
constexpr std::uint32_t walk_limit = 900; // steps for one leg
constexpr float look_tolerance = 0.05f;   // rad

using Task = WalkThrough::Task;

Task walk(float x, float z, std::uint32_t buttons = 0) {
    return {Task::walk, vec3(x, 0.0f, z), walk_limit, buttons};
}
Task look(float x, float y, float z) {
    return {Task::look, vec3(x, y, z), 240, 0};
}
Task wait(std::uint32_t steps) {
    return {Task::wait, vec3(0.0f), steps, 0};
}
Task press(std::uint32_t button) {
    return {Task::press, vec3(0.0f), 2, button};
}
// Waits until the person has been lifted to this height; negative: until the lift is at the bottom.
Task ride(float height) {
    return {Task::ride, vec3(0.0f, height, 0.0f), 1200, 0};
}

const Task route[] = {
    wait(20),
    walk(0.0f, 4.2f),
    walk(0.0f, 1.3f),
    look(0.0f, 1.0f, 0.0f), // the lantern on its pedestal
    press(simulation::button_use),
    wait(20),
    walk(-1.6f, 0.6f),
    walk(-2.4f, 0.0f),
    walk(-3.6f, -0.2f), // into the red room
    look(-6.0f, 0.8f, 0.8f),
    walk(-5.0f, -0.2f),
    look(-4.6f, 0.3f, -1.4f),
    walk(-4.75f, -0.85f),
    walk(-4.6f, -1.7f, simulation::button_run), // pushes the glowing ball
    wait(40),
    look(-7.9f, 1.1f, 2.1f),
    walk(-6.6f, 1.4f),
    wait(30),
    walk(-4.2f, 0.2f),
    walk(-2.0f, 0.0f),
    walk(-0.2f, -1.4f),
    walk(0.0f, -4.0f), // the green room
    walk(0.4f, -5.6f),
    look(0.0f, 2.6f, -7.0f),
    wait(60),
    walk(0.8f, -8.4f),
    ride(-1.0f),
    walk(2.15f, -8.4f), // onto the lift
    look(2.1f, 2.0f, -5.0f),
    ride(3.42f),
    walk(2.2f, -7.0f),
    walk(2.1f, -3.6f),
    walk(2.0f, -2.2f), // the attic
    walk(0.4f, -0.4f),
    look(-1.4f, 4.8f, 3.0f),
    wait(50),
    press(simulation::button_put_down),
    wait(40),
    look(0.6f, 3.9f, -0.6f),
    press(simulation::button_use),
    wait(10),
    walk(2.0f, -2.4f),
    walk(2.1f, -3.7f),
    walk(2.2f, -7.2f),
    walk(1.9f, -7.7f),
    wait(60),
    walk(0.4f, -7.4f), // down by the lift, or off the edge
    walk(0.0f, -4.2f),
    walk(0.0f, -1.6f),
    walk(1.6f, 0.0f),
    walk(2.3f, 0.0f),
    look(3.12f, 1.1f, 0.1f),
    press(simulation::button_use), // the swinging door
    wait(90),
    walk(4.0f, -0.9f),
    look(7.9f, 1.2f, 0.0f),
    wait(60),
    walk(5.6f, 0.0f),
    walk(6.9f, 0.3f), // up the dais
    look(5.0f, 2.0f, 0.3f),
    wait(80),
};

} // namespace

WalkThrough::WalkThrough() : tasks_(std::begin(route), std::end(route)) {}

bool WalkThrough::perform(const Task& task, const simulation::Simulation& simulation,
                          simulation::StepInput& input) const {
    const simulation::Character& person = simulation.player();
    const vec3 foot = person.capsule().foot;
    float off = 0.0f;
    switch (task.kind) {
    case Task::walk: {
        const float distance = glm::length(vec2(task.target.x - foot.x, task.target.z - foot.z));
        input = turn_to(person, vec3(task.target.x, person.eye().y - 0.15f, task.target.z), off);
        input.forward = off < 0.6f ? (distance < 0.8f ? 60 : 100) : 0;
        input.buttons = task.buttons;
        return distance < near_enough;
    }
    case Task::look:
        input = turn_to(person, task.target, off);
        return off < look_tolerance;
    case Task::wait:
        return false;
    case Task::press:
        input.buttons = spent_ == 0 ? task.buttons : 0;
        return false;
    case Task::ride:
        if (task.target.y >= 0.0f)
            return foot.y >= task.target.y;
        // The lift is at the bottom during the first and the last eighth of its period of 14 s.
        return simulation.steps() % 840 > 740 || simulation.steps() % 840 < 40;
    }
    return true;
}

simulation::StepInput WalkThrough::next(const simulation::Simulation& simulation) {
    while (!finished()) {
        const Task& task = tasks_[place_];
        simulation::StepInput input;
        const bool done = perform(task, simulation, input);
        if (!done && spent_ < task.steps) {
            ++spent_;
            return input;
        }
        ++place_;
        spent_ = 0;
    }
    return {};
}

} // namespace sunfleck::demo

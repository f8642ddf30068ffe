#include "game_demo/walk_through.h"

#include <algorithm>
#include <cmath>

namespace sunfleck::demo {
namespace {

constexpr float near_enough = 0.25f;        // m
constexpr std::uint32_t patience = 900;     // steps for one way
constexpr std::int32_t quickest_turn = 450; // 1e-4 rad a step: 2.7 rad/s
constexpr float looking_at = 0.05f;         // rad

} // namespace

WalkThrough::WalkThrough() {
    wait(20);
    walk(0.0f, 4.2f);
    walk(0.0f, 1.3f);
    look(0.0f, 1.0f, 0.0f); // the lantern on its pedestal
    press(simulation::button_use);
    wait(20);
    walk(-1.6f, 0.6f);
    walk(-2.4f, 0.0f);
    walk(-3.6f, -0.2f); // into the red room
    look(-6.0f, 0.8f, 0.8f);
    walk(-5.0f, -0.2f);
    look(-4.6f, 0.3f, -1.4f);
    walk(-4.75f, -0.85f);
    walk(-4.6f, -1.7f, simulation::button_run); // pushes the glowing ball
    wait(40);
    look(-7.9f, 1.1f, 2.1f);
    walk(-6.6f, 1.4f);
    wait(30);
    walk(-4.2f, 0.2f);
    walk(-2.0f, 0.0f);
    walk(-0.2f, -1.4f);
    walk(0.0f, -4.0f); // the green room
    walk(0.4f, -5.6f);
    look(0.0f, 2.6f, -7.0f);
    wait(60);
    walk(0.8f, -8.4f);
    ride(-1.0f);
    walk(2.15f, -8.4f); // onto the lift
    look(2.1f, 2.0f, -5.0f);
    ride(3.42f);
    walk(2.2f, -7.0f);
    walk(2.1f, -3.6f);
    walk(2.0f, -2.2f); // the attic
    walk(0.4f, -0.4f);
    look(-1.4f, 4.8f, 3.0f);
    wait(50);
    press(simulation::button_put_down);
    wait(40);
    look(0.6f, 3.9f, -0.6f);
    press(simulation::button_use);
    wait(10);
    walk(2.0f, -2.4f);
    walk(2.1f, -3.7f);
    walk(2.2f, -7.2f);
    walk(1.9f, -7.7f);
    wait(60);
    walk(0.4f, -7.4f); // down by the lift, or over the edge
    walk(0.0f, -4.2f);
    walk(0.0f, -1.6f);
    walk(1.6f, 0.0f);
    walk(2.3f, 0.0f);
    look(3.12f, 1.1f, 0.1f);
    press(simulation::button_use); // the swinging door
    wait(90);
    walk(4.0f, -0.9f);
    look(7.9f, 1.2f, 0.0f);
    wait(60);
    walk(5.6f, 0.0f);
    walk(6.9f, 0.3f); // up the dais
    look(5.0f, 2.0f, 0.3f);
    wait(80);
}

void WalkThrough::walk(float x, float z, std::uint32_t buttons) {
    tasks_.push_back({Task::walk, vec3(x, 0.0f, z), patience, buttons});
}
void WalkThrough::look(float x, float y, float z) {
    tasks_.push_back({Task::look, vec3(x, y, z), 240, 0});
}
void WalkThrough::wait(std::uint32_t steps) {
    tasks_.push_back({Task::wait, vec3(0.0f), steps, 0});
}
void WalkThrough::press(std::uint32_t button) {
    tasks_.push_back({Task::press, vec3(0.0f), 2, button});
}
// Waits until the person stands at this height; below zero: until the lift is down.
void WalkThrough::ride(float height) {
    tasks_.push_back({Task::ride, vec3(0.0f, height, 0.0f), 1200, 0});
}

simulation::StepInput WalkThrough::turn_to(const simulation::Character& person, vec3 target, float& off) const {
    const vec3 way = target - person.eye();
    const float yaw = std::remainder(std::atan2(-way.x, -way.z) - person.yaw(), 2.0f * pi);
    const float pitch = std::atan2(way.y, std::sqrt(way.x * way.x + way.z * way.z)) - person.pitch();
    off = std::max(std::abs(yaw), std::abs(pitch));
    const auto eased = [](float angle) { // slower near the end
        return std::clamp(std::int32_t(angle * 0.09f / simulation::look_unit), -quickest_turn, quickest_turn);
    };
    simulation::StepInput input;
    input.turn = eased(yaw);
    input.look_up = eased(pitch);
    return input;
}

simulation::StepInput WalkThrough::next(const simulation::Simulation& simulation) {
    while (!finished()) {
        const Task& task = tasks_[place_];
        const simulation::Character& person = simulation.player();
        float off = 0.0f;
        bool done = spent_ >= task.steps;
        simulation::StepInput input;
        switch (task.kind) {
        case Task::walk: {
            const vec3 foot = person.capsule().foot;
            vec3 way = task.target - foot;
            way.y = 0.0f;
            done = done || glm::length(way) < near_enough;
            input = turn_to(person, vec3(task.target.x, person.eye().y - 0.15f, task.target.z), off);
            input.forward = off < 0.6f ? (glm::length(way) < 0.8f ? 60 : 100) : 0;
            input.buttons = task.buttons;
            break;
        }
        case Task::look:
            input = turn_to(person, task.target, off);
            done = done || off < looking_at;
            break;
        case Task::wait:
            break;
        case Task::press:
            input.buttons = spent_ == 0 ? task.buttons : 0;
            break;
        case Task::ride:
            if (task.target.y >= 0.0f)
                done = done || person.capsule().foot.y >= task.target.y;
            else // the lift stands at the bottom for the first eighth of its period of 14 s, and the last
                done = done || (simulation.steps() % 840 > 740 || simulation.steps() % 840 < 40);
            break;
        }
        if (!done) {
            ++spent_;
            return input;
        }
        ++place_;
        spent_ = 0;
    }
    return {};
}

} // namespace sunfleck::demo

#include "game_demo/game/solution.h"

#include "game_demo/game/solution_route.h"
#include "game_demo/game/turning.h"

namespace sunfleck::demo {
namespace {

constexpr float near_enough = 0.2f;                  // m
constexpr float look_tolerance = 0.05f;              // rad
constexpr float at_bottom = 0.13f, slow_down = 0.8f; // m
constexpr std::int32_t pace = 52, slow_pace = 45;    // % of full speed

} // namespace

Solution::Solution(const GameWorld& world) : world_(world) {
    begin_here();
}
Solution::~Solution() = default;

std::string Solution::area_name() const {
    const ecs::Entity area = world_.area_entity();
    const auto* name = area.is_null() ? nullptr : world_.registry().try_get<scene::Name>(area);
    return name != nullptr ? name->name : std::string();
}

void Solution::begin_here() {
    tasks_ = solution_from(area_name());
    place_ = 0;
    spent_ = 0;
    problem_ = tasks_.empty() ? "there is no solution for '" + area_name() + "'" : "";
}

bool Solution::ended() const {
    return world_.finished() || !problem_.empty() || place_ >= tasks_.size();
}

bool Solution::walk(const Task& task, simulation::StepInput& input) const {
    const simulation::Character& person = world_.simulation().player();
    const vec3 foot = person.capsule().foot;
    const float distance = glm::length(vec2(task.target.x - foot.x, task.target.z - foot.z));
    float off = 0.0f;
    input = turn_to(person, vec3(task.target.x, person.eye().y - 0.15f, task.target.z), off);
    input.forward = off > 0.6f ? 0 : distance < slow_down ? slow_pace : pace;
    return distance < near_enough;
}

bool Solution::perform(const Task& task, simulation::StepInput& input) {
    float off = 0.0f;
    const auto entity = [&] { return scene::find_by_name(world_.registry(), task.name); };
    switch (task.kind) {
    case Task::walk:
        return walk(task, input);
    case Task::look:
        input = turn_to(world_.simulation().player(), task.target, off);
        return off < look_tolerance;
    case Task::wait:
        return false;
    case Task::press:
        input.buttons = spent_ == 0 ? task.button : 0;
        return false;
    case Task::until_open: {
        input = turn_to(world_.simulation().player(), task.target, off);
        const auto* reading = world_.registry().try_get<scene::SensorReading>(entity());
        return reading != nullptr && reading->open;
    }
    case Task::until_down: {
        const auto* world = world_.registry().try_get<scene::WorldTransform>(entity());
        return world != nullptr && world->matrix[3].y < task.target.y + at_bottom;
    }
    case Task::until_up:
        return world_.simulation().player().capsule().foot.y >= task.target.y;
    }
    return true;
}

simulation::StepInput Solution::next() {
    while (!ended()) {
        const Task& task = tasks_[place_];
        simulation::StepInput input;
        const bool done = perform(task, input);
        if (!done && spent_ < task.steps) {
            ++spent_;
            return input;
        }
        if (!done && task.must_happen())
            problem_ = task.name.empty() ? "the person did not get to where they should, in '" + area_name() + "'"
                                         : "'" + task.name + "' did not do what it should";
        ++place_;
        spent_ = 0;
    }
    return {};
}

} // namespace sunfleck::demo

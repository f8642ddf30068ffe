#include "game_demo/game/turning.h"

#include <algorithm>
#include <cmath>

namespace sunfleck::demo {
namespace {

constexpr std::int32_t max_turn = 450; // 1e-4 rad per step
constexpr float eased_share = 0.09f;   // of the angle that is left, per step

std::int32_t eased(float angle) {
    return std::clamp(std::int32_t(angle * eased_share / simulation::look_unit), -max_turn, max_turn);
}

} // namespace

simulation::StepInput turn_to(const simulation::Character& person, vec3 target, float& off) {
    const vec3 way = target - person.eye();
    const float yaw = std::remainder(std::atan2(-way.x, -way.z) - person.yaw(), 2.0f * pi);
    const float pitch = std::atan2(way.y, std::sqrt(way.x * way.x + way.z * way.z)) - person.pitch();
    off = std::max(std::abs(yaw), std::abs(pitch));
    simulation::StepInput input;
    input.turn = eased(yaw);
    input.look_up = eased(pitch);
    return input;
}

} // namespace sunfleck::demo

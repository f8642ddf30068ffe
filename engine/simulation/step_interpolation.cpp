#include "engine/simulation/step_interpolation.h"

#include <algorithm>
#include <cmath>

namespace sunfleck::simulation {
namespace {

// Upright at the eye, as what is carried hangs there.
mat4 frame_of(const DrawnEye& eye) {
    return glm::translate(mat4(1.0f), eye.position) * glm::mat4_cast(glm::angleAxis(eye.yaw, vec3(0.0f, 1.0f, 0.0f)));
}

vec3 lengths_of(const mat3& axes) {
    return {glm::length(axes[0]), glm::length(axes[1]), glm::length(axes[2])};
}

// Whether the axes, of length 1, are those of a rotation; the bound is a hundred times what rounding leaves.
bool is_rotation(const mat3& axes) {
    constexpr float rounding = 1e-5f;
    return std::abs(glm::dot(axes[0], axes[1])) < rounding && std::abs(glm::dot(axes[1], axes[2])) < rounding &&
           std::abs(glm::dot(axes[2], axes[0])) < rounding && glm::determinant(axes) > 0.0f;
}

// glm::mix rounds differently for each fraction even where both are the same: a picture at rest would tremble.
template <typename T>
T part_of_way(const T& a, const T& b, float fraction) {
    return a + (b - a) * fraction;
}

bool hangs_on(const ecs::Registry& registry, ecs::Entity entity, ecs::Entity root) {
    constexpr int deepest = 1000; // parents may form a ring
    for (int depth = 0; depth < deepest && registry.alive(entity); ++depth) {
        if (entity == root)
            return true;
        const auto* parent = registry.try_get<scene::Parent>(entity);
        if (parent == nullptr)
            return false;
        entity = parent->parent;
    }
    return false;
}

} // namespace

std::uint32_t StepClock::advance(double seconds) {
    left_ += std::clamp(seconds, 0.0, longest);
    const double due = std::floor(left_ / step_seconds);
    left_ = std::max(left_ - due * step_seconds, 0.0);
    return std::uint32_t(due);
}

mat4 between(const mat4& a, const mat4& b, float fraction) {
    mat4 result = b;
    result[3] = part_of_way(a[3], b[3], fraction);
    const mat3 from(a), to(b);
    if (from == to)
        return result;
    const vec3 before = lengths_of(from), after = lengths_of(to);
    if (std::min({before.x, before.y, before.z, after.x, after.y, after.z}) <= 0.0f)
        return b;
    const mat3 axes_before(from[0] / before.x, from[1] / before.y, from[2] / before.z);
    const mat3 axes_after(to[0] / after.x, to[1] / after.y, to[2] / after.z);
    const vec3 lengths = part_of_way(before, after, fraction);
    const bool rotates = is_rotation(axes_before) && is_rotation(axes_after);
    const mat3 turned =
        rotates ? glm::mat3_cast(glm::slerp(glm::quat_cast(axes_before), glm::quat_cast(axes_after), fraction))
                : mat3(1.0f);
    for (int i = 0; i < 3; ++i) {
        vec3 axis = turned[i];
        if (!rotates) { // mirrored or sheared: each axis for itself
            axis = part_of_way(axes_before[i], axes_after[i], fraction);
            const float length = glm::length(axis);
            axis = length > 0.1f ? axis / length : axes_after[i]; // shorter: turned round within a step
        }
        result[i] = vec4(lengths[i] * axis, 0.0f);
    }
    return result;
}

void StepInterpolation::forget() {
    fresh_ = true;
    moved_.clear();
    carried_.clear();
}

void StepInterpolation::took_step(ecs::Registry& registry, const Simulation& simulation) {
    const Jumps jumps{simulation.player().rescued(), simulation.physics().rescued(), simulation.state().carried};
    const bool jumped = fresh_ || jumps != jumps_;
    jumps_ = jumps;
    fresh_ = false;
    const Character& person = simulation.player();
    const DrawnEye eye{person.eye(), person.yaw(), person.pitch()};
    before_ = jumped ? eye : now_;
    now_ = eye;
    moved_.clear();
    registry.each_changed_since<scene::WorldTransform>(
        seen_, [&](ecs::Entity entity, const scene::WorldTransform& world) {
            const auto [known, is_new] = places_.try_emplace(entity, world.matrix);
            if (is_new || known->second == world.matrix)
                return;
            if (!jumped)
                moved_.push_back({entity, known->second, world.matrix, world.matrix});
            known->second = world.matrix;
        });
    seen_ = registry.advance_tick();
    find_carried(registry, simulation);
}

// What is carried, out of `moved_`: it follows the eye, which turns between steps, too.
void StepInterpolation::find_carried(ecs::Registry& registry, const Simulation& simulation) {
    carried_.clear();
    const ecs::Entity root = simulation.state().carried;
    if (root.is_null())
        return;
    const mat4 to_eye_before = glm::inverse(frame_of(before_)), to_eye = glm::inverse(frame_of(now_));
    registry.view<scene::WorldTransform>().each([&](ecs::Entity entity, const scene::WorldTransform& world) {
        if (!hangs_on(registry, entity, root))
            return;
        const auto moved =
            std::find_if(moved_.begin(), moved_.end(), [&](const Motion& motion) { return motion.entity == entity; });
        const mat4& before = moved != moved_.end() ? moved->before : world.matrix;
        carried_.push_back({entity, to_eye_before * before, to_eye * world.matrix, world.matrix});
    });
    std::erase_if(moved_, [&](const Motion& motion) { return hangs_on(registry, motion.entity, root); });
}

std::vector<ecs::Entity> StepInterpolation::moved() const {
    std::vector<ecs::Entity> entities;
    entities.reserve(moved_.size());
    for (const Motion& motion : moved_)
        entities.push_back(motion.entity);
    return entities;
}

DrawnEye StepInterpolation::eye(const Simulation& simulation, const DrawnMoment& moment) const {
    const Character& person = simulation.player();
    DrawnEye eye{person.eye(), person.yaw() + moment.look.x,
                 std::clamp(person.pitch() + moment.look.y, -largest_pitch, largest_pitch)};
    if (!fresh_ && moment.fraction < 1.0f)
        eye.position = part_of_way(before_.position, now_.position, moment.fraction);
    return eye;
}

void StepInterpolation::apply(ecs::Registry& registry, const Simulation& simulation, const DrawnMoment& moment) const {
    if (moment.fraction >= 1.0f && !moment.turns())
        return;
    const auto place = [&](ecs::Entity entity, const mat4& matrix) {
        if (registry.alive(entity))
            registry.update<scene::WorldTransform>(entity, {matrix});
    };
    for (const Motion& motion : moved_)
        place(motion.entity, between(motion.before, motion.now, moment.fraction));
    const mat4 frame = frame_of(eye(simulation, moment));
    for (const Motion& motion : carried_)
        place(motion.entity, frame * between(motion.before, motion.now, moment.fraction));
}

void StepInterpolation::undo(ecs::Registry& registry) const {
    for (const std::vector<Motion>* motions : {&moved_, &carried_})
        for (const Motion& motion : *motions)
            if (registry.alive(motion.entity))
                registry.update<scene::WorldTransform>(motion.entity, {motion.exact});
}

} // namespace sunfleck::simulation

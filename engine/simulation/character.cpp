#include "engine/simulation/character.h"

#include "engine/simulation/path_movers.h"

#include <algorithm>

namespace sunfleck::simulation {
namespace {

constexpr float seconds = float(step_seconds);
constexpr float walking_speed = 2.4f, running_speed = 4.2f, crouching_speed = 1.2f; // m/s
constexpr float approach_rate = 12.0f;              // 1/s, rate at which the speed approaches its target
constexpr float step_height = 0.32f, skin = 0.012f; // m
constexpr float min_ground_cosine = 0.65f;          // of the angle of the steepest walkable slope
constexpr float gravity = 9.81f, fastest_fall = 20.0f;
constexpr float crouching_height = 1.05f, height_speed = 3.0f; // m, m/s
constexpr float strength = 40.0f;                              // N, greatest pushing force

} // namespace

Character::Character(vec3 foot, float yaw, float standing_height)
    : standing_height_(standing_height), yaw_(yaw), safe_(foot), home_(foot) {
    capsule_.foot = foot;
    capsule_.height = standing_height;
}

void Character::place(vec3 foot, float yaw) {
    const vec3 home = home_;
    *this = Character(foot, yaw, standing_height_);
    home_ = home;
}

CharacterState Character::state() const {
    return {capsule_.foot, velocity_, safe_, capsule_.height, yaw_, pitch_, falling_, eye_lag_, falls_, grounded_};
}

void Character::restore(const CharacterState& state) {
    capsule_.foot = state.foot;
    capsule_.height = state.height;
    velocity_ = state.velocity;
    safe_ = state.safe;
    yaw_ = state.yaw;
    pitch_ = state.pitch;
    falling_ = state.falling;
    eye_lag_ = state.eye_lag;
    falls_ = state.falls;
    grounded_ = state.grounded;
    ground_ = ecs::null_entity;
}

vec3 Character::eye() const {
    return capsule_.foot + vec3(0.0f, capsule_.height - 0.12f - eye_lag_, 0.0f);
}

vec3 view_direction(float yaw, float pitch) {
    return {-std::sin(yaw) * std::cos(pitch), std::sin(pitch), -std::cos(yaw) * std::cos(pitch)};
}

vec3 Character::forward() const {
    return view_direction(yaw_, pitch_);
}

void Character::step(PhysicsWorld& world, const CharacterInput& input, ecs::Entity ignored) {
    yaw_ = std::remainder(yaw_ + input.turn, 2.0f * pi);
    pitch_ = std::clamp(pitch_ + input.look_up, -largest_pitch, largest_pitch);
    change_height(world, input.crouch);
    ride(world);
    leave_overlaps(world);
    const vec3 ahead(-std::sin(yaw_), 0.0f, -std::cos(yaw_)), right(std::cos(yaw_), 0.0f, -std::sin(yaw_));
    vec3 wish = std::clamp(input.forward, -1.0f, 1.0f) * ahead + std::clamp(input.right, -1.0f, 1.0f) * right;
    if (glm::length(wish) > 1.0f)
        wish = glm::normalize(wish);
    const float speed = crouching() ? crouching_speed : input.run ? running_speed : walking_speed;
    velocity_ += (wish * speed - velocity_) * std::min(1.0f, approach_rate * seconds);
    if (glm::length(velocity_) < 1e-3f)
        velocity_ = vec3(0.0f);
    const vec3 before = capsule_.foot;
    if (velocity_ != vec3(0.0f))
        walk(world, velocity_ * seconds, ignored);
    // Speed into an obstacle is lost.
    vec3 moved = (capsule_.foot - before) / seconds;
    moved.y = 0.0f;
    if (const float most = glm::length(velocity_), got = glm::length(moved); got > most)
        moved *= most / got;
    velocity_ = moved;
    fall(world, ignored);
    if (capsule_.foot.y > before.y + 0.02f && grounded_)
        eye_lag_ += capsule_.foot.y - before.y;
    eye_lag_ *= 0.8f;
    rescue(world);
}

void Character::change_height(const PhysicsWorld& world, bool crouch) {
    const float wanted = crouch ? crouching_height : standing_height_;
    if (capsule_.height == wanted)
        return;
    Capsule next = capsule_;
    const float most = height_speed * seconds;
    next.height += std::clamp(wanted - capsule_.height, -most, most);
    // Standing up needs headroom.
    if (next.height > capsule_.height && world.sweep(capsule_, vec3(0.0f, next.height - capsule_.height + skin, 0.0f)))
        return;
    capsule_ = next;
}

void Character::ride(const PhysicsWorld& world) {
    if (!grounded_ || ground_.is_null())
        return;
    const vec3 motion = world.displacement_at(ground_, capsule_.foot);
    if (motion == vec3(0.0f))
        return;
    float share = 1.0f;
    if (const auto hit = world.sweep(capsule_, motion, ground_))
        share = hit->fraction;
    capsule_.foot += motion * share;
}

// A person who is squeezed has no place that is free. They stay on this side of walls and floors, and overlap with what
// moves, which gives way.
void Character::leave_overlaps(const PhysicsWorld& world) {
    for (const auto obstacles : {PhysicsWorld::Obstacles::all, PhysicsWorld::Obstacles::fixed})
        for (int round = 0; round < 4; ++round) {
            const vec3 out = world.depenetration(capsule_, obstacles);
            if (glm::length(out) < 1e-4f)
                return;
            capsule_.foot += out;
        }
}

// Moves as far as possible, then slides along the obstacle.
void Character::slide(PhysicsWorld& world, vec3 motion, ecs::Entity ignored) {
    for (int round = 0; round < 4 && glm::length(motion) > 1e-5f; ++round) {
        const auto hit = world.sweep(capsule_, motion, ignored);
        if (!hit) {
            capsule_.foot += motion;
            return;
        }
        const float length = glm::length(motion);
        const vec3 direction = motion / length;
        const float free = std::max(0.0f, hit->fraction * length - skin);
        capsule_.foot += direction * free;
        vec3 normal = hit->normal;
        if (hit->mass > 0.0f) {
            const float momentum = std::min(strength * seconds, hit->mass * glm::length(velocity_) * 0.5f);
            world.push(hit->entity, -vec3(normal.x, 0.0f, normal.z) * momentum, hit->point);
        }
        // Slopes that are too steep to stand on act as walls.
        if (normal.y < min_ground_cosine && normal.y > -0.2f) {
            normal.y = 0.0f;
            if (glm::length(normal) < 1e-4f)
                return;
            normal = glm::normalize(normal);
        }
        motion = direction * (length - free);
        motion -= normal * std::min(glm::dot(motion, normal), 0.0f);
    }
}

// Along the ground, and again from one step higher; the attempt that gets further counts.
void Character::walk(PhysicsWorld& world, vec3 motion, ecs::Entity ignored) {
    const Capsule start = capsule_;
    slide(world, motion, ignored);
    if (!grounded_ || crouching())
        return;
    const Capsule flat = capsule_;
    const auto distance = [&](const Capsule& c) {
        const vec3 way = c.foot - start.foot;
        return way.x * motion.x + way.z * motion.z;
    };
    if (distance(flat) > 0.98f * glm::dot(motion, motion))
        return;
    capsule_ = start;
    float up = step_height;
    if (const auto hit = world.sweep(capsule_, vec3(0.0f, up, 0.0f), ignored))
        up = std::max(0.0f, hit->fraction * up - skin);
    capsule_.foot.y += up;
    slide(world, motion, ignored);
    const auto down = world.sweep(capsule_, vec3(0.0f, -up - skin, 0.0f), ignored);
    const bool stands = down && down->mass <= 0.0f && can_stand_on(world, *down, ignored);
    if (stands)
        capsule_.foot.y -= std::max(0.0f, down->fraction * (up + skin) - skin);
    if (!stands || distance(capsule_) < distance(flat) + 1e-4f)
        capsule_ = flat;
}

void Character::fall(PhysicsWorld& world, ecs::Entity ignored) {
    falling_ = std::min(falling_ + gravity * seconds, fastest_fall);
    // On the ground, follows it down steps and slopes.
    const float way = grounded_ ? std::max(step_height, falling_ * seconds) : falling_ * seconds + skin;
    const auto hit = world.sweep(capsule_, vec3(0.0f, -way, 0.0f), ignored);
    if (hit && can_stand_on(world, *hit, ignored)) {
        capsule_.foot.y -= std::max(0.0f, hit->fraction * way - skin);
        grounded_ = true;
        ground_ = hit->entity;
        falling_ = 0.0f;
        safe_ = capsule_.foot;
        falls_ = 0;
        return;
    }
    if (grounded_) {
        grounded_ = false;
        ground_ = ecs::null_entity;
        falling_ = gravity * seconds;
    }
    slide(world, vec3(0.0f, -falling_ * seconds, 0.0f), ignored);
}

// The capsule's round end meets the edge of a step at an angle: use the face beyond the edge instead.
bool Character::can_stand_on(const PhysicsWorld& world, const SweepHit& hit, ecs::Entity ignored) const {
    if (hit.normal.y > min_ground_cosine)
        return true;
    if (hit.normal.y < 0.05f)
        return false;
    vec3 outwards(hit.normal.x, 0.0f, hit.normal.z);
    outwards = glm::normalize(outwards);
    const vec3 above = hit.point - 0.03f * outwards + vec3(0.0f, 0.06f, 0.0f);
    const auto face = world.ray(above, vec3(0.0f, -0.12f, 0.0f), ignored);
    return face && face->normal.y > min_ground_cosine;
}

void Character::rescue(const PhysicsWorld& world) {
    if (is_finite(capsule_.foot) && capsule_.foot.y > world.bounds().minimum.y - 1.0f)
        return;
    ++rescued_;
    if (++falls_ > falls_before_home) // there is no floor
        safe_ = home_;
    capsule_.foot = safe_ + vec3(0.0f, 0.1f, 0.0f);
    velocity_ = vec3(0.0f);
    falling_ = 0.0f;
}

} // namespace sunfleck::simulation

#include "engine/simulation/character.h"

#include "engine/simulation/path_movers.h"

#include <algorithm>

namespace sunfleck::simulation {
namespace {

constexpr float seconds = float(step_seconds);
constexpr float walking = 2.4f, running = 4.2f, crouched = 1.2f; // m/s
constexpr float quickness = 12.0f;                               // 1/s, how fast the speed follows
constexpr float step_height = 0.32f, skin = 0.012f;              // m
constexpr float steepest = 0.65f;                                // cosine of the slope that one can stand on
constexpr float gravity = 9.81f, fastest_fall = 20.0f;
constexpr float crouching_height = 1.05f, height_speed = 3.0f; // m, m/s
constexpr float strength = 40.0f;                              // N s a second of pushing, at most
constexpr float largest_pitch = 1.5f;                          // rad

} // namespace

Character::Character(vec3 foot, float yaw, float standing_height)
    : standing_height_(standing_height), yaw_(yaw), safe_(foot) {
    capsule_.foot = foot;
    capsule_.height = standing_height;
}

vec3 Character::eye() const {
    return capsule_.foot + vec3(0.0f, capsule_.height - 0.12f - eye_lag_, 0.0f);
}

vec3 Character::forward() const {
    return {-std::sin(yaw_) * std::cos(pitch_), std::sin(pitch_), -std::cos(yaw_) * std::cos(pitch_)};
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
    const float speed = crouching() ? crouched : input.run ? running : walking;
    velocity_ += (wish * speed - velocity_) * std::min(1.0f, quickness * seconds);
    if (glm::length(velocity_) < 1e-3f)
        velocity_ = vec3(0.0f);
    const vec3 before = capsule_.foot;
    if (velocity_ != vec3(0.0f))
        walk(world, velocity_ * seconds, ignored);
    // Blocked speed is lost.
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
    // There must be room to stand up.
    if (next.height > capsule_.height && world.sweep(capsule_, vec3(0.0f, next.height - capsule_.height + skin, 0.0f)))
        return;
    capsule_ = next;
}

void Character::ride(const PhysicsWorld& world) {
    if (!grounded_ || ground_.is_null())
        return;
    const vec3 motion = world.carried_by(ground_, capsule_.foot);
    if (motion == vec3(0.0f))
        return;
    float share = 1.0f;
    if (const auto hit = world.sweep(capsule_, motion, ground_))
        share = hit->fraction;
    capsule_.foot += motion * share;
}

void Character::leave_overlaps(const PhysicsWorld& world) {
    for (int round = 0; round < 4; ++round) {
        const vec3 out = world.way_out(capsule_);
        if (glm::length(out) < 1e-4f)
            return;
        capsule_.foot += out;
    }
}

// Goes as far as it can, then along what is in the way.
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
        // What is too steep to stand on is a wall.
        if (normal.y < steepest && normal.y > -0.2f) {
            normal.y = 0.0f;
            if (glm::length(normal) < 1e-4f)
                return;
            normal = glm::normalize(normal);
        }
        motion = direction * (length - free);
        motion -= normal * std::min(glm::dot(motion, normal), 0.0f);
    }
}

// Along the ground, and the same from a step higher; whichever gets further counts.
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
    // On the ground it is followed down steps and slopes.
    const float way = grounded_ ? std::max(step_height, falling_ * seconds) : falling_ * seconds + skin;
    const auto hit = world.sweep(capsule_, vec3(0.0f, -way, 0.0f), ignored);
    if (hit && can_stand_on(world, *hit, ignored)) {
        capsule_.foot.y -= std::max(0.0f, hit->fraction * way - skin);
        grounded_ = true;
        ground_ = hit->entity;
        falling_ = 0.0f;
        safe_ = capsule_.foot;
        return;
    }
    if (grounded_) {
        grounded_ = false;
        ground_ = ecs::null_entity;
        falling_ = gravity * seconds;
    }
    slide(world, vec3(0.0f, -falling_ * seconds, 0.0f), ignored);
}

// The round end of the capsule meets the edge of a step aslant: what counts there is the face beyond the edge.
bool Character::can_stand_on(const PhysicsWorld& world, const SweepHit& hit, ecs::Entity ignored) const {
    if (hit.normal.y > steepest)
        return true;
    if (hit.normal.y < 0.05f)
        return false;
    vec3 outwards(hit.normal.x, 0.0f, hit.normal.z);
    outwards = glm::normalize(outwards);
    const vec3 above = hit.point - 0.03f * outwards + vec3(0.0f, 0.06f, 0.0f);
    const auto face = world.ray(above, vec3(0.0f, -0.12f, 0.0f), ignored);
    return face && face->normal.y > steepest;
}

void Character::rescue(const PhysicsWorld& world) {
    if (is_finite(capsule_.foot) && capsule_.foot.y > world.bounds().minimum.y - 1.0f)
        return;
    ++rescued_;
    capsule_.foot = safe_ + vec3(0.0f, 0.1f, 0.0f);
    velocity_ = vec3(0.0f);
    falling_ = 0.0f;
}

} // namespace sunfleck::simulation

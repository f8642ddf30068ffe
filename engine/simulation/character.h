// A walking character: slides along walls, climbs steps, rides lifts, pushes loose bodies, crouches; never jumps.
#pragma once

#include "engine/simulation/physics_world.h"

namespace sunfleck::simulation {

inline constexpr float largest_pitch = 1.5f; // rad, up and down

// `yaw` 0 looks along -Z and increases to the left.
vec3 view_direction(float yaw, float pitch);

struct CharacterInput {
    float forward = 0.0f, right = 0.0f; // -1 to 1
    float turn = 0.0f, look_up = 0.0f;  // rad in this step
    bool run = false, crouch = false;
};

// All that a Character goes on from, but for what it stands on, which the next step finds.
struct CharacterState {
    vec3 foot{0.0f}, velocity{0.0f}, safe{0.0f};
    float height = 0.0f, yaw = 0.0f, pitch = 0.0f, falling = 0.0f, eye_lag = 0.0f;
    std::uint32_t falls = 0;
    bool grounded = false;
};

class Character {
public:
    static constexpr std::uint32_t falls_before_home = 2;

    Character() = default;
    Character(vec3 foot, float yaw, float standing_height);

    // One fixed step, after that of the physics world.
    void step(PhysicsWorld& world, const CharacterInput& input, ecs::Entity ignored = ecs::null_entity);

    // Stands there from now on, at rest; home is where it was.
    void place(vec3 foot, float yaw);

    CharacterState state() const;
    void restore(const CharacterState& state);

    const Capsule& capsule() const { return capsule_; }
    vec3 eye() const;
    vec3 forward() const; // view direction
    float standing_height() const { return standing_height_; }
    float yaw() const { return yaw_; }
    float pitch() const { return pitch_; }
    vec3 velocity() const { return velocity_; }
    bool grounded() const { return grounded_; }
    bool crouching() const { return capsule_.height < standing_height_ - 0.05f; }
    ecs::Entity stands_on() const { return ground_; }
    // How often the person fell out of the level and was put back where they last stood; after falls_before_home in a
    // row, where they began.
    std::uint64_t rescued() const { return rescued_; }

private:
    void change_height(const PhysicsWorld& world, bool crouch);
    void ride(const PhysicsWorld& world);
    void leave_overlaps(const PhysicsWorld& world);
    void slide(PhysicsWorld& world, vec3 motion, ecs::Entity ignored);
    void walk(PhysicsWorld& world, vec3 motion, ecs::Entity ignored);
    void fall(PhysicsWorld& world, ecs::Entity ignored);
    bool can_stand_on(const PhysicsWorld& world, const SweepHit& hit, ecs::Entity ignored) const;
    void rescue(const PhysicsWorld& world);

    Capsule capsule_;
    float standing_height_ = 1.7f;
    float yaw_ = 0.0f, pitch_ = 0.0f;
    vec3 velocity_{0.0f};
    float falling_ = 0.0f; // m/s, downwards
    bool grounded_ = false;
    ecs::Entity ground_;
    vec3 safe_{0.0f}, home_{0.0f};
    std::uint32_t falls_ = 0; // out of the level, since the person stood last
    float eye_lag_ = 0.0f;    // m by which the eye lags below its position after a step up
    std::uint64_t rescued_ = 0;
};

} // namespace sunfleck::simulation

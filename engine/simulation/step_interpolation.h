// What is drawn between two fixed steps. A window's frames fall anywhere between them: drawn as they are after the last
// step, things that move evenly would advance by two steps in one frame and by one in the next. So the picture is up to
// a step late, and all that moved is shown a part of its way from the step before to the last one. Only world
// transforms are changed, and only while a frame is prepared: simulation, hashes and recordings never see it.
#pragma once

#include "engine/simulation/path_movers.h"
#include "engine/simulation/simulation.h"

#include <unordered_map>

namespace sunfleck::simulation {

// Turns the time of frames into whole steps and the part of a step that is left.
class StepClock {
public:
    static constexpr double longest = 0.2; // s: after a longer stall, the simulation does not catch up

    // The number of steps that are due after a frame of this time, s.
    std::uint32_t advance(double seconds);
    // How much of the next step has gone by, 0 to 1: the share of the way that is shown.
    float fraction() const { return float(left_ / step_seconds); }
    void reset() { left_ = 0.0; }

private:
    double left_ = 0.0; // s
};

// Where the person sees from.
struct DrawnEye {
    vec3 position{0.0f};
    float yaw = 0.0f, pitch = 0.0f; // rad, as of Character
    vec3 forward() const { return view_direction(yaw, pitch); }
    bool operator==(const DrawnEye&) const = default;
};

// What a frame shows of the time since the step before the last one.
struct DrawnMoment {
    float fraction = 1.0f; // of the way to the last step, 0 to 1
    vec2 look{0.0f};       // rad to the left and up that the person has turned since: shown at once
    bool turns() const { return look != vec2(0.0f); }
};

class StepInterpolation {
public:
    // After each step. What jumped (a body or a person that was put back, the lantern into a hand or out of it) is no
    // motion: nothing is interpolated over that step.
    void took_step(ecs::Registry& registry, const Simulation& simulation);
    // The world was exchanged (restart, checkpoint, reset of a room): the next step has none before it.
    void forget();

    // Whether the eye moved in the last step; and what else did, but for what is carried, which moves with the eye.
    bool eye_moves() const { return before_ != now_; }
    std::vector<ecs::Entity> moved() const;
    DrawnEye eye(const Simulation& simulation, const DrawnMoment& moment) const;
    // Sets the world transforms of what moved to their place at that moment; what is carried keeps its place before the
    // eye. To be undone before the next step, and before anything but drawing looks at them.
    void apply(ecs::Registry& registry, const Simulation& simulation, const DrawnMoment& moment) const;
    // World transforms are those of the simulation once more.
    void undo(ecs::Registry& registry) const;

private:
    struct Motion {
        ecs::Entity entity;
        mat4 before{1.0f}, now{1.0f}; // in the world, or before the eye
        mat4 exact{1.0f};             // in the world, after the last step
    };
    struct Jumps { // counts of what jumps, and what is carried: another value means a jump
        std::uint64_t persons = 0, bodies = 0;
        ecs::Entity carried;
        bool operator==(const Jumps&) const = default;
    };
    void find_carried(ecs::Registry& registry, const Simulation& simulation);

    bool fresh_ = true;
    ecs::Tick seen_ = 0;
    Jumps jumps_;
    DrawnEye before_, now_;
    std::unordered_map<ecs::Entity, mat4> places_;
    std::vector<Motion> moved_;   // in the last step
    std::vector<Motion> carried_; // relative to the eye
};

// A part of the way from one place to another, 0 to 1. Rotations turn evenly and keep their lengths.
mat4 between(const mat4& a, const mat4& b, float fraction);

} // namespace sunfleck::simulation

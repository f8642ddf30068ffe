// The simulation of a level: fixed steps of movers, physics and one person. The state after n steps is a function of
// the level and the n inputs alone.
#pragma once

#include "engine/scene/simulation_components.h"
#include "engine/simulation/character.h"
#include "engine/simulation/input_recording.h"

namespace sunfleck::simulation {

// What a person can do with the object in front of them.
enum class Interaction { none, open, close, switch_lamps, take };

class Simulation {
public:
    // The registry holds the freshly loaded level. The person starts at its PlayerStart (or the camera "view", or the
    // centre of the level).
    Simulation(ecs::Registry& registry, const scene::MeshStore& meshes);

    // One step of step_seconds.
    void step(ecs::Registry& registry, const StepInput& input);

    std::uint64_t steps() const { return steps_; }
    const Character& player() const { return player_; }
    const PhysicsWorld& physics() const { return physics_; }
    PhysicsWorld& physics() { return physics_; }
    Interaction possible_interaction(ecs::Registry& registry) const;
    bool carries_lantern() const { return !carried_.is_null(); }

    // Hash of everything that moves, of switches and lamps and the person: equal worlds have equal hashes.
    std::uint64_t world_hash(ecs::Registry& registry) const;

private:
    struct Target {
        Interaction interaction = Interaction::none;
        ecs::Entity entity;
    };
    static Character find_start(ecs::Registry& registry, const Bounds& bounds);
    Target find_target(ecs::Registry& registry) const;
    void use(ecs::Registry& registry);
    void put_down(ecs::Registry& registry);
    void carry(ecs::Registry& registry);
    void advance_movers(ecs::Registry& registry, bool back);

    PhysicsWorld physics_;
    Character player_;
    ecs::Entity carried_;
    std::uint32_t held_buttons_ = 0;
    std::uint64_t steps_ = 0;
};

// Switches the emitters named by the switch on or off.
void apply_switch(ecs::Registry& registry, const scene::LightSwitch& state);

} // namespace sunfleck::simulation

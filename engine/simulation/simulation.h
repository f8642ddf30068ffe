// The simulation of a level: fixed steps of movers, physics and one person. The state after n steps is a function of
// the level and the n inputs alone.
#pragma once

#include "engine/scene/simulation_components.h"
#include "engine/simulation/character.h"
#include "engine/simulation/input_recording.h"

namespace sunfleck::simulation {

// What a person can do with the object in front of them.
enum class Interaction { none, open, close, switch_lamps, take };

// A lantern that was put down: it goes along with what it stands on.
struct Standing {
    ecs::Entity lantern, ground;
    vec3 place{0.0f}; // in the world
    quat rotation{1.0f, 0.0f, 0.0f, 0.0f};
};

// What a simulation goes on from, beside the components of the registry.
struct SimulationState {
    std::uint64_t steps = 0;
    std::uint32_t held_buttons = 0;
    CharacterState person;
    ecs::Entity carried; // lantern, or null
    std::vector<Standing> standing;
};

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
    ecs::Entity carried() const { return carried_; } // lantern, or null

    // For the rules of a game: the person stands there, at rest, and looks that way.
    void place_player(vec3 foot, vec3 ahead);
    void place_player_at_start();
    // Into the person's hand, or to a place (relative to its parent, if it has one). Entities with a Lantern only.
    void hand_lantern(ecs::Registry& registry, ecs::Entity lantern);
    void put_lantern(ecs::Registry& registry, ecs::Entity lantern, const scene::Transform& transform);

    SimulationState state() const { return {steps_, held_buttons_, player_.state(), carried_, standing_}; }
    // After Transform, MoverState and LightSwitch components were set to what they were in that state: world_hash is
    // then what it was. Bodies are at rest.
    void restore(ecs::Registry& registry, const SimulationState& state);

    // Hash of everything that moves, of switches and lamps, of what sensors read, and of the person: equal worlds have
    // equal hashes.
    std::uint64_t world_hash(ecs::Registry& registry) const;

private:
    struct Target {
        Interaction interaction = Interaction::none;
        ecs::Entity entity;
    };
    static Character find_start(ecs::Registry& registry, const Bounds& bounds);
    Target find_target(ecs::Registry& registry) const;
    static Target find_used(const ecs::Registry& registry, ecs::Entity seen);
    void find_lanterns(ecs::Registry& registry, const scene::MeshStore& meshes);
    float cosine_to_lantern(const ecs::Registry& registry, ecs::Entity lantern) const;
    void use(ecs::Registry& registry);
    void take(ecs::Registry& registry, ecs::Entity lantern);
    void forget_standing(ecs::Entity lantern);
    void stand(const ecs::Registry& registry, const Standing& standing);
    void stand_where_it_is(ecs::Registry& registry, ecs::Entity lantern);
    void move_standing(ecs::Registry& registry);
    void put_down(ecs::Registry& registry);
    void let_go(ecs::Registry& registry, const scene::Transform& transform);
    void carry(ecs::Registry& registry);
    void advance_movers(ecs::Registry& registry, bool back);
    void link_sensors(ecs::Registry& registry);
    bool sensors_open(const ecs::Registry& registry, ecs::Entity mover) const;
    void show_readings(ecs::Registry& registry) const;

    PhysicsWorld physics_;
    const Character start_;
    Character player_;
    ecs::Entity carried_;
    std::vector<Standing> standing_;
    std::vector<std::pair<ecs::Entity, float>> lantern_heights_;          // m, above their origins
    using SensorLinks = std::vector<std::pair<ecs::Entity, ecs::Entity>>; // sensor, mover
    SensorLinks sensor_opens_, sensor_shows_;
    std::uint32_t held_buttons_ = 0;
    std::uint64_t steps_ = 0;
};

// Switches the emitters named by the switch on or off.
void apply_switch(ecs::Registry& registry, const scene::LightSwitch& state);

} // namespace sunfleck::simulation

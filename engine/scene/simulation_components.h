// Components of the simulation beyond Mover.
#pragma once

#include "engine/scene/components.h"

namespace sunfleck::scene {

// Control points of a Mover with path `spline`: a closed Catmull-Rom curve through the first `count` of them, in the
// space of the entity's parent.
struct SplinePath {
    static constexpr std::uint32_t max_points = 6;
    std::uint32_t count = 3;
    vec3 point_1{0.0f}, point_2{0.0f}, point_3{0.0f}, point_4{0.0f}, point_5{0.0f}, point_6{0.0f};
    bool face_travel = false; // the entity's -Z axis follows the curve
    static const TypeDescription& description();
};

enum class BodyShape : std::uint32_t { box, sphere, hull, none };

// A body that physics moves (its entity also has a Mover with path `none`). Static meshes are obstacles without any
// component, and movers on paths are obstacles that push; shape `none` excludes an entity from physics.
struct RigidBody {
    BodyShape shape = BodyShape::box; // of the mesh's bounds, or their hull
    float mass = 1.0f;                // kg; 0: an obstacle that physics does not move
    float friction = 0.6f;
    float restitution = 0.2f;
    float rolling_friction = 0.01f;
    static const TypeDescription& description();
};

// When used by a person, switches the emitters of other entities on and off.
struct LightSwitch {
    std::string lamps; // names of entities, separated by commas
    bool on = true;
    static const TypeDescription& description();
};

// Start position of the player, facing the entity's -Z.
struct PlayerStart {
    float height = 1.72f; // m, standing
    static const TypeDescription& description();
};

// A lamp that a person can pick up, carry and put down.
struct Lantern {
    bool carried = false;
    static const TypeDescription& description();
};

// Progress of an activated mover; set by the simulation.
struct MoverState {
    static constexpr bool derived = true;
    float progress = 0.0f; // 0 at rest, 1 at the far end
    bool open = false;     // direction: towards the far end
};

void register_simulation_components(ecs::Registry& registry);

} // namespace sunfleck::scene

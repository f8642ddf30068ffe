// Components of the simulation beyond Mover.
#pragma once

#include "engine/scene/components.h"
#include "engine/scene/entity_names.h"

#include <vector>

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

// A lamp that a person can pick up, carry and put down, with all that is below it; no obstacle.
struct Lantern {
    bool carried = false;
    static const TypeDescription& description();
};

// A place that measures the light that arrives, direct and reflected, and opens movers by it. Its point is the entity's
// origin, its normal the entity's +Z.
struct LightSensor {
    vec3 threshold{1.0f};    // W/m2; a colour of 0 is not needed
    float purity = 0.0f;     // times the strongest colour that is not needed counts against those that are
    std::string opens;       // names of movers with activation `sensor`, separated by commas
    std::string shows;       // names of such movers whose travel shows the share, see sensor_gauge_end
    bool keeps_open = false; // once it has opened
    static const TypeDescription& description();
};

// A part of a game's level: the box of half_size about the entity's origin, in its own space.
struct GameArea {
    vec3 half_size{3.0f, 2.0f, 3.0f};     // m
    std::string title;                    // shown on entering
    std::string hint;                     // shown on request
    vec3 entry{0.0f};                     // where a reset puts the player's feet, from the origin, m
    vec3 entry_facing{0.0f, 0.0f, -1.0f}; // and where they look
    bool goal = false;                    // entering it ends the game
    static const TypeDescription& description();
};

// What a sensor measures, set by gi::LightSensors at each fixed step.
struct SensorReading {
    static constexpr bool derived = true;
    vec3 irradiance{0.0f}; // W/m2
    float share = 0.0f;    // of what it needs: 1 is enough
    bool open = false;
    bool operator==(const SensorReading&) const = default;
};

// A sensor opens where its share reaches 1 and closes below this.
inline constexpr float sensor_closes_below = 0.8f;
// The share at which a mover that shows it is at its far end.
inline constexpr float sensor_gauge_end = 1.5f;
// The least share, over the colours that the sensor needs, of the threshold that the irradiance reaches.
float sensor_share(const LightSensor& sensor, vec3 irradiance);
// What a sensor reads now that it had read `before`.
SensorReading next_reading(const LightSensor& sensor, const SensorReading& before, vec3 irradiance);

// Progress of an activated mover; set by the simulation.
struct MoverState {
    static constexpr bool derived = true;
    float progress = 0.0f; // 0 at rest, 1 at the far end
    bool open = false;     // direction: towards the far end
    bool operator==(const MoverState&) const = default;
};

void register_simulation_components(ecs::Registry& registry);

} // namespace sunfleck::scene

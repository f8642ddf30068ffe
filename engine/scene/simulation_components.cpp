#include "engine/scene/simulation_components.h"

#include <algorithm>

namespace sunfleck::scene {
namespace {

constexpr float unbounded_share = 1e30f;

} // namespace

const TypeDescription& SplinePath::description() {
    static const TypeDescription type{
        "SplinePath",
        1,
        "Closed curve that a mover follows.",
        {SUNFLECK_FIELD(SplinePath, count, "", 2, 6, "Number of control points"),
         SUNFLECK_FIELD(SplinePath, point_1, "m", -1e4, 1e4, "First point"),
         SUNFLECK_FIELD(SplinePath, point_2, "m", -1e4, 1e4, "Second point"),
         SUNFLECK_FIELD(SplinePath, point_3, "m", -1e4, 1e4, "Third point"),
         SUNFLECK_FIELD(SplinePath, point_4, "m", -1e4, 1e4, "Fourth point"),
         SUNFLECK_FIELD(SplinePath, point_5, "m", -1e4, 1e4, "Fifth point"),
         SUNFLECK_FIELD(SplinePath, point_6, "m", -1e4, 1e4, "Sixth point"),
         SUNFLECK_FIELD(SplinePath, face_travel, "", 0, 1, "Orients the entity along the curve")}};
    return type;
}

const TypeDescription& RigidBody::description() {
    static const TypeDescription type{
        "RigidBody",
        1,
        "A rigid body that physics moves.",
        {SUNFLECK_CHOICE(RigidBody, shape, "Collision shape", "box", "sphere", "hull", "none"),
         SUNFLECK_FIELD(RigidBody, mass, "kg", 0, 1e5, "0: an obstacle that physics does not move"),
         SUNFLECK_FIELD(RigidBody, friction, "", 0, 10, "Coefficient of friction"),
         SUNFLECK_FIELD(RigidBody, restitution, "", 0, 1, "Coefficient of restitution"),
         SUNFLECK_FIELD(RigidBody, rolling_friction, "", 0, 1, "Coefficient of rolling friction")}};
    return type;
}

const TypeDescription& LightSwitch::description() {
    static const TypeDescription type{
        "LightSwitch",
        1,
        "Switches lamps on and off.",
        {SUNFLECK_FIELD(LightSwitch, lamps, "", 0, 0,
                        "Names of the lamps, separated by commas; a name with a comma stands in quotation marks")
             .flagged(names_entities),
         SUNFLECK_FIELD(LightSwitch, on, "", 0, 1, "Whether the lamps are on")}};
    return type;
}

const TypeDescription& PlayerStart::description() {
    static const TypeDescription type{"PlayerStart",
                                      1,
                                      "Start position of the player, facing -Z.",
                                      {SUNFLECK_FIELD(PlayerStart, height, "m", 0.5, 3, "Height of the player")}};
    return type;
}

const TypeDescription& Lantern::description() {
    static const TypeDescription type{"Lantern",
                                      1,
                                      "A lamp that can be carried.",
                                      {SUNFLECK_FIELD(Lantern, carried, "", 0, 1, "Held by the player")}};
    return type;
}

const TypeDescription& LightSensor::description() {
    static const TypeDescription type{
        "LightSensor",
        1,
        "Measures the light that arrives at the entity's origin, on the side of its +Z, and opens movers by it.",
        {SUNFLECK_FIELD(LightSensor, threshold, "W/m2", 0, 1e9,
                        "Irradiance that opens it, by colour; a colour of 0 is not needed"),
         SUNFLECK_FIELD(LightSensor, purity, "", 0, 10,
                        "How often the strongest colour that is not needed is subtracted from those that are"),
         SUNFLECK_FIELD(LightSensor, opens, "", 0, 0,
                        "Names of movers with activation 'sensor', separated by commas; a mover that several sensors "
                        "name opens while all of them are open")
             .flagged(names_entities),
         SUNFLECK_FIELD(LightSensor, shows, "", 0, 0,
                        "Names of movers with activation 'sensor' that show its share, separated by commas: at rest at "
                        "0, at their far end at 1.5")
             .flagged(names_entities),
         SUNFLECK_FIELD(LightSensor, keeps_open, "", 0, 1, "Stays open once it has opened")}};
    return type;
}

const TypeDescription& GameArea::description() {
    static const TypeDescription type{
        "GameArea",
        1,
        "A part of a game's level, a box about the entity's origin.",
        {SUNFLECK_FIELD(GameArea, half_size, "m", 0.01, 1e4, "Half of the box's size"),
         SUNFLECK_FIELD(GameArea, title, "", 0, 0, "Shown on entering"),
         SUNFLECK_FIELD(GameArea, hint, "", 0, 0, "Shown on request"),
         SUNFLECK_FIELD(GameArea, entry, "m", -1e4, 1e4, "Where a reset puts the player's feet, from the origin"),
         SUNFLECK_FIELD(GameArea, entry_facing, "", -1, 1, "Where the player looks after a reset"),
         SUNFLECK_FIELD(GameArea, goal, "", 0, 1, "Entering it ends the game")}};
    return type;
}

float sensor_share(const LightSensor& sensor, vec3 irradiance) {
    float share = unbounded_share, other = 0.0f;
    for (int c = 0; c < 3; ++c)
        if (sensor.threshold[c] <= 0.0f)
            other = std::max(other, irradiance[c]);
    for (int c = 0; c < 3; ++c)
        if (sensor.threshold[c] > 0.0f)
            share = std::min(share, (irradiance[c] - sensor.purity * other) / sensor.threshold[c]);
    return share == unbounded_share ? 0.0f : std::max(share, 0.0f);
}

SensorReading next_reading(const LightSensor& sensor, const SensorReading& before, vec3 irradiance) {
    SensorReading next;
    next.irradiance = irradiance;
    next.share = sensor_share(sensor, irradiance);
    next.open = next.share >= (before.open ? sensor_closes_below : 1.0f) || (before.open && sensor.keeps_open);
    return next;
}

void register_simulation_components(ecs::Registry& registry) {
    registry.register_component<SplinePath>();
    registry.register_component<RigidBody>();
    registry.register_component<LightSwitch>();
    registry.register_component<PlayerStart>();
    registry.register_component<Lantern>();
    registry.register_component<LightSensor>();
    registry.register_component<GameArea>();
}

} // namespace sunfleck::scene

#include "engine/scene/simulation_components.h"

namespace sunfleck::scene {

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
        {SUNFLECK_FIELD(LightSwitch, lamps, "", 0, 0, "Names of the lamps, separated by commas"),
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

void register_simulation_components(ecs::Registry& registry) {
    registry.register_component<SplinePath>();
    registry.register_component<RigidBody>();
    registry.register_component<LightSwitch>();
    registry.register_component<PlayerStart>();
    registry.register_component<Lantern>();
}

} // namespace sunfleck::scene

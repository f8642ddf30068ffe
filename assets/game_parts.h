// Building blocks of a game of light: sensors with their signs and gauges, and what they open; things that a player
// slides, opens, pushes and carries.
#pragma once

#include "assets/house_parts.h"

namespace sunfleck::assets {

// The colour that a sensor needs, which is a shape, too: on the sensor, and on the gauge beside the door that it opens.
enum class Sign { white, red, green, violet };

class GameParts {
public:
    explicit GameParts(SceneBuilder& builder) : s_(builder) {}

    // `normal`: of the side that measures.
    void sensor(const std::string& name, vec3 position, vec3 normal, const scene::LightSensor& sensor);
    // A plate of the sign's shape and colour on a wall.
    void sign(const std::string& name, Sign sign, vec3 centre, vec3 facing_to, float radius = 0.14f);
    // An upright scale on a wall: its marker, a mover called `name`, climbs with the sensor's share; a line with the
    // sign shows how much is needed.
    void gauge(const std::string& name, Sign sign, vec3 foot, vec3 facing_to);

    void sensor_door(const std::string& name, vec3 centre, vec3 size, vec3 travel);
    // Boxes that a person's "use" moves along `travel` and back, or turns about an upright axis at `hinge`.
    void sliding_panel(const std::string& name, const Box& box, vec3 travel, vec3 colour);
    void shutter(const std::string& name, const Box& box, vec3 hinge, float angle, vec3 colour);
    // A block to push.
    void block(const std::string& name, vec3 foot, float side, float mass, vec3 colour);
    void sun(const std::string& name, vec3 position, vec3 target, vec3 intensity, vec2 angles);
    void area(const std::string& name, const Room& room, const scene::GameArea& area);

private:
    ecs::Entity empty(const std::string& name, vec3 position);
    // Takes no part in physics and casts no shadow.
    void ornament(ecs::Entity entity);

    SceneBuilder& s_;
};

} // namespace sunfleck::assets

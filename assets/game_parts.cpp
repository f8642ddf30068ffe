#include "assets/game_parts.h"

namespace sunfleck::assets {
namespace {

const vec3 dark(0.05f), steel(0.30f, 0.32f, 0.34f);

constexpr float gauge_height = 0.9f;

// Sides of the sign's shape; many: a disc.
int sides_of(Sign sign) {
    switch (sign) {
    case Sign::red:
        return 3;
    case Sign::green:
        return 4;
    case Sign::violet:
        return 5;
    case Sign::white:
        break;
    }
    return 40;
}

vec3 colour_of(Sign sign) {
    switch (sign) {
    case Sign::red:
        return {0.85f, 0.10f, 0.08f};
    case Sign::green:
        return {0.12f, 0.70f, 0.15f};
    case Sign::violet:
        return {0.62f, 0.14f, 0.75f};
    case Sign::white:
        break;
    }
    return vec3(0.9f);
}

scene::Transform placed(vec3 position, quat rotation = quat(1.0f, 0.0f, 0.0f, 0.0f)) {
    scene::Transform transform;
    transform.position = position;
    transform.rotation = rotation;
    return transform;
}

// Maps +Y to the direction.
quat upright_on(vec3 facing_to) {
    return facing(facing_to) * glm::angleAxis(0.5f * pi, vec3(1.0f, 0.0f, 0.0f));
}

scene::Mover on_line(vec3 travel, float period, scene::MoverActivation activation) {
    scene::Mover mover;
    mover.path = scene::MoverPath::line;
    mover.travel = travel;
    mover.period = period;
    mover.activation = activation;
    return mover;
}

vec3 size_of(const Box& box) {
    return box.highest - box.lowest;
}
vec3 centre_of(const Box& box) {
    return 0.5f * (box.lowest + box.highest);
}

} // namespace

ecs::Entity GameParts::empty(const std::string& name, vec3 position) {
    ecs::Registry& registry = s_.registry();
    const ecs::Entity entity = registry.create();
    registry.emplace<scene::Name>(entity, {name});
    registry.emplace<scene::Transform>(entity, placed(position));
    return entity;
}

void GameParts::ornament(ecs::Entity entity) {
    scene::RigidBody body;
    body.shape = scene::BodyShape::none;
    s_.registry().emplace<scene::RigidBody>(entity, body);
    s_.registry().emplace<scene::ShadowCasting>(entity, {false});
}

void GameParts::sensor(const std::string& name, vec3 position, vec3 normal, const scene::LightSensor& sensor) {
    const ecs::Entity entity = empty(name, position);
    s_.registry().patch<scene::Transform>(entity, [&](scene::Transform& t) { t.rotation = facing(normal); });
    s_.registry().emplace<scene::LightSensor>(entity, sensor);
    // The glass lies just behind the point that is measured.
    s_.add(name + " eye", scene::make_cylinder(0.1f, 0.03f, 24), diffuse(dark),
           placed(position - 0.025f * normal, upright_on(normal)));
}

void GameParts::sign(const std::string& name, Sign sign, vec3 centre, vec3 facing_to, float radius) {
    s_.add(name, scene::make_cylinder(radius, 0.02f, sides_of(sign)), diffuse(colour_of(sign)),
           placed(centre, upright_on(facing_to)));
}

void GameParts::gauge(const std::string& name, Sign shape, vec3 foot, vec3 facing_to) {
    const vec3 across = glm::abs(glm::cross(facing_to, vec3(0, 1, 0))), up(0, 1, 0);
    const auto slab = [&](const std::string& part, vec3 centre, float width, float height, vec3 colour) {
        const vec3 size = across * width + up * height + glm::abs(facing_to) * 0.02f;
        s_.add(name + part, scene::make_box(size), diffuse(colour), placed(centre));
    };
    slab(" scale", foot + 0.5f * gauge_height * up, 0.12f, gauge_height + 0.08f, dark);
    // Progress along a line is eased: 3 t^2 - 2 t^3.
    const float t = 1.0f / scene::sensor_gauge_end, needed = gauge_height * t * t * (3.0f - 2.0f * t);
    slab(" line", foot + needed * up + 0.012f * facing_to, 0.2f, 0.02f, colour_of(shape));
    sign(name + " sign", shape, foot + (gauge_height + 0.22f) * up, facing_to);
    const ecs::Entity marker = s_.add(name, scene::make_box(across * 0.14f + up * 0.045f + glm::abs(facing_to) * 0.03f),
                                      diffuse(vec3(0.95f, 0.9f, 0.75f)), placed(foot + 0.02f * facing_to));
    s_.registry().patch<scene::Material>(marker, show_base_colour);
    s_.mover(marker, on_line(gauge_height * up, 1.0f, scene::MoverActivation::sensor));
    ornament(marker);
}

void GameParts::sensor_door(const std::string& name, vec3 centre, vec3 size, vec3 travel) {
    const ecs::Entity door = s_.add(name, scene::make_box(size), diffuse(steel), placed(centre));
    s_.mover(door, on_line(travel, 2.4f, scene::MoverActivation::sensor));
    s_.registry().emplace<scene::SurfacePattern>(door, {PatternKind::planks, vec3(0.22f, 0.24f, 0.26f), 0.3f});
}

void GameParts::sliding_panel(const std::string& name, const Box& box, vec3 travel, vec3 colour) {
    const ecs::Entity panel = s_.add(name, scene::make_box(size_of(box)), diffuse(colour), placed(centre_of(box)));
    s_.mover(panel, on_line(travel, 4.0f, scene::MoverActivation::use));
}

void GameParts::shutter(const std::string& name, const Box& box, vec3 hinge, float angle, vec3 colour) {
    const ecs::Entity panel = s_.add(name, scene::make_box(size_of(box)), diffuse(colour), placed(centre_of(box)));
    scene::Mover mover;
    mover.path = scene::MoverPath::hinge;
    mover.centre = hinge;
    mover.angle = angle;
    mover.period = 3.2f;
    mover.activation = scene::MoverActivation::use;
    s_.mover(panel, mover);
}

void GameParts::block(const std::string& name, vec3 foot, float side, float mass, vec3 colour) {
    const ecs::Entity entity =
        s_.add(name, scene::make_box(vec3(side)), diffuse(colour), placed(foot + vec3(0.0f, 0.5f * side, 0.0f)));
    s_.mover(entity, {});
    scene::RigidBody body;
    body.mass = mass;
    body.friction = 0.5f;
    body.restitution = 0.0f;
    s_.registry().emplace<scene::RigidBody>(entity, body);
}

void GameParts::sun(const std::string& name, vec3 position, vec3 target, vec3 intensity, vec2 angles) {
    const ecs::Entity entity = empty(name, position);
    s_.registry().patch<scene::Transform>(entity, [&](scene::Transform& t) { t.rotation = facing(position - target); });
    s_.registry().emplace<scene::SpotLight>(entity, {intensity, angles.x, angles.y});
}

void GameParts::area(const std::string& name, const Room& room, const scene::GameArea& described) {
    const vec3 centre = 0.5f * (room.lowest + room.highest);
    scene::GameArea area = described;
    area.half_size = 0.5f * (room.highest - room.lowest);
    area.entry = described.entry - centre;
    s_.registry().emplace<scene::GameArea>(empty(name, centre), area);
}

} // namespace sunfleck::assets

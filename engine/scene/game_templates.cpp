#include "engine/scene/game_templates.h"

#include "engine/scene/procedural.h"
#include "engine/scene/simulation_components.h"

namespace sunfleck::scene {
namespace {

constexpr vec3 door_size(1.06f, 2.15f, 0.045f); // m: a person is 1.72 m tall

void give_shape(ecs::Registry& registry, ecs::Entity entity, MeshStore& meshes, Mesh mesh, const char* name) {
    mesh.name = name;
    registry.emplace<Transform>(entity);
    registry.emplace<MeshInstance>(entity, {meshes.add(std::move(mesh))});
    registry.emplace<Material>(entity);
}

// Aside by its own width.
void let_slide(ecs::Registry& registry, ecs::Entity entity, float width, float period, MoverActivation activation) {
    Mover mover;
    mover.path = MoverPath::line;
    mover.travel = vec3(width, 0.0f, 0.0f);
    mover.period = period;
    mover.activation = activation;
    registry.emplace<Mover>(entity, mover);
}

// Below the entity, with a shape.
ecs::Entity give_part(ecs::Registry& registry, ecs::Entity entity, MeshStore& meshes, Mesh mesh, const char* name) {
    const ecs::Entity part = registry.create();
    give_shape(registry, part, meshes, std::move(mesh), name);
    registry.emplace<Name>(part, {name});
    registry.emplace<Parent>(part, {entity});
    return part;
}

// The same, but no obstacle to light.
ecs::Entity hang_on(ecs::Registry& registry, ecs::Entity entity, MeshStore& meshes, Mesh mesh, const char* name) {
    const ecs::Entity part = give_part(registry, entity, meshes, std::move(mesh), name);
    registry.emplace<ShadowCasting>(part, {false});
    return part;
}

void move_to(ecs::Registry& registry, ecs::Entity entity, float height) {
    registry.patch<Transform>(entity, [&](Transform& transform) { transform.position.y = height; });
}

void give_area(ecs::Registry& registry, ecs::Entity entity, vec3 half_size, bool goal) {
    registry.emplace<Transform>(entity);
    GameArea area;
    area.half_size = half_size;
    area.title = goal ? "The end" : "A room";
    area.entry = vec3(0.0f, -half_size.y, 0.0f);
    area.goal = goal;
    registry.emplace<GameArea>(entity, area);
}

} // namespace

void make_player_start(ecs::Registry& registry, ecs::Entity entity, MeshStore&, float) {
    registry.emplace<Transform>(entity);
    registry.emplace<PlayerStart>(entity);
}

void make_sliding_door(ecs::Registry& registry, ecs::Entity entity, MeshStore& meshes, float) {
    give_shape(registry, entity, meshes, make_box(door_size), "door");
    let_slide(registry, entity, door_size.x, 2.4f, MoverActivation::sensor);
}

void make_sliding_panel(ecs::Registry& registry, ecs::Entity entity, MeshStore& meshes, float) {
    const vec3 size(1.6f, 2.0f, 0.06f);
    give_shape(registry, entity, meshes, make_box(size), "panel");
    let_slide(registry, entity, size.x, 4.0f, MoverActivation::use);
}

// It stands on its base; a ball shows where the light comes from.
void make_lantern(ecs::Registry& registry, ecs::Entity entity, MeshStore& meshes, float) {
    constexpr float height = 0.3f, plate = 0.03f, radius = 0.09f; // m
    registry.emplace<Transform>(entity);
    registry.emplace<Mover>(entity);
    registry.emplace<Lantern>(entity);
    const vec3 brass(0.55f, 0.40f, 0.18f);
    for (const char* name : {"base", "cap"}) {
        const ecs::Entity part = hang_on(registry, entity, meshes, make_cylinder(radius, plate, 20), name);
        registry.patch<Material>(part, [&](Material& material) { material.base_colour = brass; });
        move_to(registry, part, name[0] == 'b' ? 0.5f * plate : height - 0.5f * plate);
    }
    const ecs::Entity glow = hang_on(registry, entity, meshes, make_sphere(0.05f, 16, 8), "glow");
    registry.patch<Material>(glow, [](Material& material) {
        material.base_colour = vec3(1.0f, 0.93f, 0.72f);
        material.unlit = true;
    });
    move_to(registry, glow, 0.5f * height);
    const ecs::Entity light = registry.create();
    registry.emplace<Name>(light, {"light"});
    registry.emplace<Parent>(light, {entity});
    registry.emplace<Transform>(light);
    registry.emplace<PointLight>(light, {vec3(3.2f, 3.1f, 2.95f)});
    move_to(registry, light, 0.5f * height);
}

void make_lift(ecs::Registry& registry, ecs::Entity entity, MeshStore& meshes, float) {
    give_shape(registry, entity, meshes, make_box(vec3(1.5f, 0.12f, 1.5f)), "lift");
    Mover mover;
    mover.path = MoverPath::line;
    mover.travel = vec3(0.0f, 1.5f, 0.0f); // half of it, on the clock
    mover.period = 14.0f;
    mover.phase = -0.25f; // starts at the bottom
    mover.easing = MoverEasing::dwell;
    registry.emplace<Mover>(entity, mover);
}

void make_block(ecs::Registry& registry, ecs::Entity entity, MeshStore& meshes, float) {
    give_shape(registry, entity, meshes, make_box(vec3(0.8f)), "block");
    registry.emplace<Mover>(entity);
    RigidBody body;
    body.mass = 3.0f;
    body.friction = 0.5f;
    body.restitution = 0.0f;
    registry.emplace<RigidBody>(entity, body);
}

void make_shutter(ecs::Registry& registry, ecs::Entity entity, MeshStore& meshes, float) {
    const vec3 size(1.0f, 1.4f, 0.04f);
    registry.emplace<Transform>(entity);
    const ecs::Entity panel = give_part(registry, entity, meshes, make_box(size), "panel");
    registry.patch<Transform>(panel, [&](Transform& transform) { transform.position.x = 0.5f * size.x; });
    Mover mover;
    mover.path = MoverPath::hinge;
    mover.angle = -1.9f;
    mover.period = 3.2f;
    mover.activation = MoverActivation::use;
    registry.emplace<Mover>(panel, mover);
}

// Looks along +Z.
void make_gauge(ecs::Registry& registry, ecs::Entity entity, MeshStore& meshes, float) {
    constexpr float height = 0.9f, thickness = 0.02f; // m
    Mesh scale = make_box(vec3(0.12f, height + 0.08f, thickness));
    for (vec3& position : scale.positions)
        position.y += 0.5f * height;
    give_shape(registry, entity, meshes, std::move(scale), "gauge");
    registry.patch<Material>(entity, [](Material& material) { material.base_colour = vec3(0.05f); });
    // Progress along a line is eased: 3 t^2 - 2 t^3.
    const float t = 1.0f / sensor_gauge_end, needed = height * t * t * (3.0f - 2.0f * t);
    const ecs::Entity line = give_part(registry, entity, meshes, make_box(vec3(0.2f, 0.02f, thickness)), "line");
    registry.patch<Transform>(line, [&](Transform& place) { place.position = vec3(0.0f, needed, thickness); });
    const ecs::Entity marker = hang_on(registry, entity, meshes, make_box(vec3(0.14f, 0.045f, 0.03f)), "marker");
    registry.patch<Transform>(marker, [&](Transform& place) { place.position.z = thickness; });
    registry.patch<Material>(marker, [](Material& material) {
        material.base_colour = vec3(0.95f, 0.9f, 0.75f);
        material.unlit = true;
    });
    Mover mover;
    mover.path = MoverPath::line;
    mover.travel = vec3(0.0f, height, 0.0f);
    mover.activation = MoverActivation::sensor;
    registry.emplace<Mover>(marker, mover);
    RigidBody ornament;
    ornament.shape = BodyShape::none;
    registry.emplace<RigidBody>(marker, ornament);
}

// Its glass lies just behind the point that is measured, which looks along +Z.
void make_light_sensor(ecs::Registry& registry, ecs::Entity entity, MeshStore& meshes, float size) {
    const float radius = 0.1f * size, thickness = 0.3f * radius;
    Mesh mesh = make_cylinder(radius, thickness, 24);
    for (vec3& position : mesh.positions)
        position = vec3(position.x, -position.z, position.y - 0.75f * thickness);
    for (vec3& normal : mesh.normals)
        normal = vec3(normal.x, -normal.z, normal.y);
    give_shape(registry, entity, meshes, std::move(mesh), "sensor");
    registry.patch<Material>(entity, [](Material& material) { material.base_colour = vec3(0.05f); });
    registry.emplace<LightSensor>(entity);
}

void make_game_area(ecs::Registry& registry, ecs::Entity entity, MeshStore&, float) {
    give_area(registry, entity, vec3(3.0f, 1.5f, 3.0f), false);
}

void make_goal(ecs::Registry& registry, ecs::Entity entity, MeshStore&, float) {
    give_area(registry, entity, vec3(1.0f, 1.5f, 1.0f), true);
}

} // namespace sunfleck::scene

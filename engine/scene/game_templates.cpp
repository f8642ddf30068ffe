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

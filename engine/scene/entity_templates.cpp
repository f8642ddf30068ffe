#include "engine/scene/entity_templates.h"

#include "engine/scene/game_templates.h"
#include "engine/scene/procedural.h"

namespace sunfleck::scene {
namespace {

// Radiant intensity of a lamp that lights what is some sizes away as a room is lit, W/sr for each m2 of size.
constexpr float usual_intensity = 40.0f;

void place(ecs::Registry& registry, ecs::Entity entity, const quat& rotation = quat(1.0f, 0.0f, 0.0f, 0.0f)) {
    Transform transform;
    // Without negative zeros, which files do not keep.
    transform.rotation = quat(rotation.w + 0.0f, rotation.x + 0.0f, rotation.y + 0.0f, rotation.z + 0.0f);
    registry.emplace<Transform>(entity, transform);
}

void give_mesh(ecs::Registry& registry, ecs::Entity entity, MeshStore& meshes, Mesh mesh, const char* name) {
    mesh.name = name;
    registry.emplace<MeshInstance>(entity, {meshes.add(std::move(mesh))});
    registry.emplace<Material>(entity);
    place(registry, entity);
}

// Maps +Z to -Y: area lights look down.
quat downwards() {
    return glm::angleAxis(0.5f * pi, vec3(1.0f, 0.0f, 0.0f));
}

void make_area_light(ecs::Registry& registry, ecs::Entity entity, MeshStore& meshes, AreaLight light) {
    Mesh mesh = make_area_light_mesh(light);
    mesh.name = "lamp";
    registry.emplace<MeshInstance>(entity, {meshes.add(std::move(mesh))});
    Material material;
    material.base_colour = vec3(0.0f);
    material.emission = light.radiance;
    registry.emplace<Material>(entity, material);
    registry.emplace<AreaLight>(entity, light);
    place(registry, entity, light.shape == AreaShape::sphere ? quat(1.0f, 0.0f, 0.0f, 0.0f) : downwards());
}

void make_rectangle_light(ecs::Registry& registry, ecs::Entity entity, MeshStore& meshes, float size) {
    AreaLight light;
    light.width = light.height = size;
    light.radiance = vec3(usual_intensity);
    make_area_light(registry, entity, meshes, light);
}

void make_disc_light(ecs::Registry& registry, ecs::Entity entity, MeshStore& meshes, float size) {
    AreaLight light;
    light.shape = AreaShape::disc;
    light.radius = 0.5f * size;
    light.radiance = vec3(usual_intensity);
    make_area_light(registry, entity, meshes, light);
}

void make_sphere_light(ecs::Registry& registry, ecs::Entity entity, MeshStore& meshes, float size) {
    AreaLight light;
    light.shape = AreaShape::sphere;
    light.radius = 0.25f * size;
    light.radiance = vec3(usual_intensity);
    make_area_light(registry, entity, meshes, light);
}

void make_point_light(ecs::Registry& registry, ecs::Entity entity, MeshStore&, float size) {
    place(registry, entity);
    registry.emplace<PointLight>(entity, {vec3(usual_intensity * size * size)});
}

void make_spot_light(ecs::Registry& registry, ecs::Entity entity, MeshStore&, float size) {
    place(registry, entity, glm::angleAxis(-0.5f * pi, vec3(1.0f, 0.0f, 0.0f))); // maps -Z to -Y
    SpotLight light;
    light.intensity = vec3(2.0f * usual_intensity * size * size);
    registry.emplace<SpotLight>(entity, light);
}

void make_sun(ecs::Registry& registry, ecs::Entity entity, MeshStore&, float) {
    place(registry, entity, glm::angleAxis(-1.0f, vec3(1.0f, 0.0f, 0.0f)));
    registry.emplace<DirectionalLight>(entity, {vec3(2.0f, 1.9f, 1.7f)});
}

void make_sky(ecs::Registry& registry, ecs::Entity entity, MeshStore&, float) {
    place(registry, entity);
    registry.emplace<Environment>(entity, {vec3(0.28f, 0.30f, 0.34f)});
}

void make_box_entity(ecs::Registry& registry, ecs::Entity entity, MeshStore& meshes, float size) {
    give_mesh(registry, entity, meshes, make_box(vec3(size)), "box");
}

void make_ball(ecs::Registry& registry, ecs::Entity entity, MeshStore& meshes, float size) {
    give_mesh(registry, entity, meshes, make_sphere(0.5f * size, 48, 24), "ball");
}

void make_cylinder_entity(ecs::Registry& registry, ecs::Entity entity, MeshStore& meshes, float size) {
    give_mesh(registry, entity, meshes, make_cylinder(0.5f * size, size), "cylinder");
}

void make_floor(ecs::Registry& registry, ecs::Entity entity, MeshStore& meshes, float size) {
    Mesh mesh = make_rectangle(10.0f * size, 10.0f * size);
    for (vec3& position : mesh.positions)
        position = vec3(position.x, 0.0f, -position.y);
    for (vec3& normal : mesh.normals)
        normal = vec3(0.0f, 1.0f, 0.0f);
    give_mesh(registry, entity, meshes, std::move(mesh), "floor");
}

void make_group(ecs::Registry& registry, ecs::Entity entity, MeshStore&, float) {
    place(registry, entity);
}

void make_camera(ecs::Registry& registry, ecs::Entity entity, MeshStore&, float) {
    place(registry, entity);
    registry.emplace<Camera>(entity);
}

constexpr EntityTemplate templates[] = {
    {"Rectangle light", "An area light that radiates downwards", "Lights", make_rectangle_light},
    {"Disc light", "A round area light that radiates downwards", "Lights", make_disc_light},
    {"Sphere light", "A ball that radiates in all directions", "Lights", make_sphere_light},
    {"Point light", "Radiates equally in all directions from a point", "Lights", make_point_light},
    {"Spot light", "Radiates in a cone, downwards", "Lights", make_spot_light},
    {"Sun", "Parallel light", "Lights", make_sun},
    {"Sky", "Uniform light from all around", "Lights", make_sky},
    {"Box", "A grey box", "Shapes", make_box_entity},
    {"Ball", "A grey ball", "Shapes", make_ball},
    {"Cylinder", "A grey upright cylinder", "Shapes", make_cylinder_entity},
    {"Floor", "A grey horizontal square", "Shapes", make_floor},
    {"Player start", "Where a person begins, feet at its origin, looking along -Z", "Game", make_player_start},
    {"Sliding door", "Slides aside while the light sensors that name it are open", "Game", make_sliding_door},
    {"Sliding panel", "A person slides it aside, and back", "Game", make_sliding_panel},
    {"Lift", "Goes up and down by itself", "Game", make_lift},
    {"Block", "A person pushes it along", "Game", make_block},
    {"Shutter", "A person swings it open, and shut", "Game", make_shutter},
    {"Gauge", "Its marker shows what the light sensors read that name it", "Game", make_gauge},
    {"Lantern", "A person takes it, carries it and puts it down", "Game", make_lantern},
    {"Light sensor", "Measures the light that arrives along +Z, direct and reflected; opens what it names", "Game",
     make_light_sensor},
    {"Game area", "A room of the game: its title and hint, where a reset of it puts the person", "Game",
     make_game_area},
    {"Goal", "Ends the game for who enters it", "Game", make_goal},
    {"Group", "A place that other entities can be put under", "Other", make_group},
    {"Camera", "A view that can be chosen by name", "Other", make_camera}};

} // namespace

std::span<const EntityTemplate> entity_templates() {
    return templates;
}

bool needs_other_mesh(const AreaLight& before, const AreaLight& now) {
    return before.shape != now.shape || before.width != now.width || before.height != now.height ||
           before.radius != now.radius;
}

} // namespace sunfleck::scene

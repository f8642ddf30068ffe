#include "assets/scene_builder.h"

namespace sunfleck::assets {

ecs::Entity SceneBuilder::named(const std::string& name, const scene::Transform& transform) {
    const ecs::Entity entity = registry_.create();
    registry_.emplace<scene::Name>(entity, {name});
    registry_.emplace<scene::Transform>(entity, transform);
    return entity;
}

ecs::Entity SceneBuilder::add(const std::string& name, scene::Mesh mesh, const scene::Material& material,
                              const scene::Transform& transform) {
    const ecs::Entity entity = named(name, transform);
    mesh.name = name;
    registry_.emplace<scene::MeshInstance>(entity, {meshes_.add(std::move(mesh))});
    registry_.emplace<scene::Material>(entity, material);
    return entity;
}

ecs::Entity SceneBuilder::box(const std::string& name, vec3 lowest, vec3 highest, const scene::Material& material) {
    scene::Transform transform;
    transform.position = 0.5f * (lowest + highest);
    return add(name, scene::make_box(highest - lowest), material, transform);
}

ecs::Entity SceneBuilder::quad(const std::string& name, vec3 corner, vec3 u, vec3 v, const scene::Material& material) {
    scene::Mesh mesh;
    mesh.positions = {corner, corner + u, corner + u + v, corner + v};
    mesh.normals.assign(4, glm::normalize(glm::cross(u, v)));
    mesh.indices = {0, 1, 2, 0, 2, 3};
    return add(name, std::move(mesh), material);
}

void SceneBuilder::room(vec3 lo, vec3 hi, vec3 floor, vec3 ceiling, const vec3 (&walls)[4]) {
    const vec3 size = hi - lo;
    const vec3 x(size.x, 0, 0), y(0, size.y, 0), z(0, 0, size.z);
    quad("floor", lo, z, x, diffuse(floor));
    quad("ceiling", vec3(lo.x, hi.y, lo.z), x, z, diffuse(ceiling));
    quad("wall x-", lo, y, z, diffuse(walls[0]));
    quad("wall x+", vec3(hi.x, lo.y, lo.z), z, y, diffuse(walls[1]));
    quad("wall z-", lo, x, y, diffuse(walls[2]));
    quad("wall z+", vec3(lo.x, lo.y, hi.z), y, x, diffuse(walls[3]));
}

ecs::Entity SceneBuilder::area_light(const std::string& name, const scene::AreaLight& light,
                                     const scene::Transform& transform) {
    scene::Material material = diffuse(vec3(0.0f));
    material.emission = light.radiance;
    const ecs::Entity entity = add(name, scene::make_area_light_mesh(light), material, transform);
    registry_.emplace<scene::AreaLight>(entity, light);
    return entity;
}

ecs::Entity SceneBuilder::ceiling_light(const std::string& name, vec3 centre, float width, float depth,
                                        vec3 radiance) {
    scene::AreaLight light;
    light.width = width;
    light.height = depth;
    light.radiance = radiance;
    scene::Transform transform;
    transform.position = centre;
    transform.rotation = glm::angleAxis(0.5f * pi, vec3(1.0f, 0.0f, 0.0f)); // +Z turns to -Y
    return area_light(name, light, transform);
}

quat facing(vec3 direction) {
    const vec3 z = glm::normalize(direction);
    const vec3 x = glm::normalize(glm::cross(std::abs(z.y) < 0.99f ? vec3(0, 1, 0) : vec3(0, 0, 1), z));
    return glm::quat_cast(mat3(x, glm::cross(z, x), z));
}

void SceneBuilder::camera(const std::string& name, vec3 position, vec3 target, float vertical_degrees) {
    scene::Transform transform;
    transform.position = position;
    transform.rotation = facing(position - target);
    const ecs::Entity entity = named(name, transform);
    registry_.emplace<scene::Camera>(entity, {glm::radians(vertical_degrees)});
}

void SceneBuilder::exposure(float ev100) {
    const ecs::Entity entity = named("exposure", {});
    registry_.emplace<scene::Exposure>(entity, {ev100});
}

} // namespace sunfleck::assets

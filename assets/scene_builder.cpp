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
    return instance(name, this->mesh(name, std::move(mesh)), material, transform);
}

std::uint32_t SceneBuilder::mesh(const std::string& name, scene::Mesh mesh) {
    mesh.name = name;
    return meshes_.add(std::move(mesh));
}

ecs::Entity SceneBuilder::instance(const std::string& name, std::uint32_t mesh, const scene::Material& material,
                                   const scene::Transform& transform) {
    const ecs::Entity entity = named(name, transform);
    registry_.emplace<scene::MeshInstance>(entity, {mesh});
    registry_.emplace<scene::Material>(entity, material);
    return entity;
}

ecs::Entity SceneBuilder::spot_light(const std::string& name, const scene::Transform& transform,
                                     const scene::SpotLight& light) {
    const ecs::Entity entity = named(name, transform);
    registry_.emplace<scene::SpotLight>(entity, light);
    return entity;
}

ecs::Entity SceneBuilder::point_light(const std::string& name, vec3 position, vec3 intensity) {
    scene::Transform transform;
    transform.position = position;
    const ecs::Entity entity = named(name, transform);
    registry_.emplace<scene::PointLight>(entity, {intensity});
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

void SceneBuilder::ceiling_with_lamps(vec3 lo, vec3 hi, vec3 colour, const std::vector<Lamp>& lamps) {
    const scene::Material material = diffuse(colour);
    int pieces = 0;
    const auto piece = [&](float x0, float x1, float z0, float z1) {
        quad("ceiling" + (pieces > 0 ? " " + std::to_string(pieces) : std::string()), vec3(x0, hi.y, z0),
             vec3(x1 - x0, 0, 0), vec3(0, 0, z1 - z0), material);
        ++pieces;
    };
    float x = lo.x;
    for (const Lamp& lamp : lamps) {
        const vec2 half(0.5f * lamp.width, 0.5f * lamp.depth), a = lamp.centre - half, b = lamp.centre + half;
        piece(x, a.x, lo.z, hi.z);
        piece(a.x, b.x, lo.z, a.y);
        piece(a.x, b.x, b.y, hi.z);
        ceiling_light(lamp.name, vec3(lamp.centre.x, hi.y, lamp.centre.y), lamp.width, lamp.depth, lamp.radiance);
        x = b.x;
    }
    piece(x, hi.x, lo.z, hi.z);
}

void SceneBuilder::room(vec3 lo, vec3 hi, vec3 floor, vec3 ceiling, const vec3 (&walls)[4],
                        const std::vector<Lamp>& lamps) {
    const vec3 size = hi - lo;
    const vec3 x(size.x, 0, 0), y(0, size.y, 0), z(0, 0, size.z);
    quad("floor", lo, z, x, diffuse(floor));
    ceiling_with_lamps(lo, hi, ceiling, lamps);
    quad("wall x-", lo, y, z, diffuse(walls[0]));
    quad("wall x+", vec3(hi.x, lo.y, lo.z), z, y, diffuse(walls[1]));
    // These two meet the ceiling where it is split: they reach slightly above it, so that no ray slips through.
    const vec3 overlap = y + vec3(0.0f, 0.002f, 0.0f);
    quad("wall z-", lo, x, overlap, diffuse(walls[2]));
    quad("wall z+", vec3(lo.x, lo.y, hi.z), overlap, x, diffuse(walls[3]));
}

ecs::Entity SceneBuilder::area_light(const std::string& name, const scene::AreaLight& light,
                                     const scene::Transform& transform) {
    scene::Material material = diffuse(vec3(0.0f));
    material.emission = light.radiance;
    const ecs::Entity entity = add(name, scene::make_area_light_mesh(light), material, transform);
    registry_.emplace<scene::AreaLight>(entity, light);
    return entity;
}

ecs::Entity SceneBuilder::ceiling_light(const std::string& name, vec3 centre, float width, float depth, vec3 radiance) {
    scene::AreaLight light;
    light.width = width;
    light.height = depth;
    light.radiance = radiance;
    scene::Transform transform;
    transform.position = centre;
    transform.rotation = glm::angleAxis(0.5f * pi, vec3(1.0f, 0.0f, 0.0f)); // maps +Z to -Y
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

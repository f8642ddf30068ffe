// Functions to describe a scene in code.
#pragma once

#include "engine/scene/procedural.h"

#include <string>
#include <vector>

namespace sunfleck::assets {

inline scene::Material diffuse(vec3 colour) {
    scene::Material material;
    material.base_colour = colour;
    return material;
}

class SceneBuilder {
public:
    SceneBuilder(ecs::Registry& registry, scene::MeshStore& meshes) : registry_(registry), meshes_(meshes) {
        scene::register_components(registry);
    }

    ecs::Entity add(const std::string& name, scene::Mesh mesh, const scene::Material& material,
                    const scene::Transform& transform = {});
    // A mesh for several entities, and an entity that uses it.
    std::uint32_t mesh(const std::string& name, scene::Mesh mesh);
    ecs::Entity instance(const std::string& name, std::uint32_t mesh, const scene::Material& material,
                         const scene::Transform& transform);
    // Box given by its lowest and highest corner.
    ecs::Entity box(const std::string& name, vec3 lowest, vec3 highest, const scene::Material& material);
    // Rectangle given by a corner and two edges; the edges are counter-clockwise seen from the front.
    ecs::Entity quad(const std::string& name, vec3 corner, vec3 u, vec3 v, const scene::Material& material);
    // The inside of a box: floor, ceiling, and walls in the order x-, x+, z-, z+.
    // The ceiling has openings in which `lamps` sit flush; lamps are sorted by x and do not overlap in x.
    struct Lamp {
        std::string name;
        vec2 centre; // x, z
        float width, depth;
        vec3 radiance;
    };
    void room(vec3 lowest, vec3 highest, vec3 floor, vec3 ceiling, const vec3 (&walls)[4],
              const std::vector<Lamp>& lamps = {});
    void ceiling_with_lamps(vec3 lowest, vec3 highest, vec3 colour, const std::vector<Lamp>& lamps);
    // Faces downwards, centred on `centre`.
    ecs::Entity ceiling_light(const std::string& name, vec3 centre, float width, float depth, vec3 radiance);
    ecs::Entity area_light(const std::string& name, const scene::AreaLight& light, const scene::Transform& transform);
    ecs::Entity spot_light(const std::string& name, const scene::Transform& transform, const scene::SpotLight& light);
    ecs::Entity point_light(const std::string& name, vec3 position, vec3 intensity);
    void camera(const std::string& name, vec3 position, vec3 target, float vertical_degrees);
    void exposure(float ev100);
    void mover(ecs::Entity entity, const scene::Mover& mover) { registry_.emplace<scene::Mover>(entity, mover); }
    ecs::Registry& registry() { return registry_; }

private:
    ecs::Entity named(const std::string& name, const scene::Transform& transform);
    ecs::Registry& registry_;
    scene::MeshStore& meshes_;
};

// Rotation that maps the local Z axis to `direction`.
quat facing(vec3 direction);

} // namespace sunfleck::assets

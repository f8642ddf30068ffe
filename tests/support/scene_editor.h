// A scene that is edited at random: entities and components come and go, move, change parents, materials and meshes.
#pragma once

#include "engine/scene/components.h"
#include "engine/scene/mesh_store.h"

#include <random>
#include <vector>

namespace sunfleck::tests {

inline scene::Mesh triangle(float size) {
    scene::Mesh mesh;
    mesh.positions = {vec3(0.0f), vec3(size, 0.0f, 0.0f), vec3(0.0f, size, 0.0f)};
    mesh.normals.assign(3, vec3(0.0f, 0.0f, 1.0f));
    mesh.indices = {0, 1, 2};
    return mesh;
}

// Edits a scene at random, with few values, so that many edits change nothing.
class SceneEditor {
public:
    ecs::Registry registry;
    scene::MeshStore meshes;

    SceneEditor() { meshes.add(triangle(1.0f)); }

    void edit() {
        const ecs::Entity entity = alive_.empty() ? ecs::null_entity : alive_[random_() % alive_.size()];
        const std::uint32_t action = number(24);
        if (alive_.empty() || action < 3)
            create();
        else if (action == 3 && alive_.size() > 10)
            destroy(entity);
        else if (action < 8)
            edit_surface(entity, action);
        else if (action < 14)
            edit_structure(entity, action);
        else
            edit_place(entity, action);
        scene::update_world_transforms(registry);
    }

private:
    template <typename T>
    void toggle(ecs::Entity entity, T value = {}) {
        if (registry.has<T>(entity))
            registry.remove<T>(entity);
        else
            registry.emplace<T>(entity, value);
    }
    float some() { return float(number(3)); }
    std::uint32_t number(std::uint32_t below) { return std::uint32_t(random_() % below); }

    scene::MaterialTextures textures() {
        scene::MaterialTextures made;
        made.base_colour.texture = std::int32_t(number(2));
        return made;
    }

    void create() {
        alive_.push_back(registry.create());
        const ecs::Entity entity = alive_.back();
        registry.emplace<scene::Transform>(entity, {vec3(some(), some(), 0.0f)});
        if (random_() % 4 != 0)
            registry.emplace<scene::MeshInstance>(entity, {number(meshes.size() + 1)});
        if (random_() % 2 == 0)
            registry.emplace<scene::Material>(entity);
        if (random_() % 4 == 0)
            registry.emplace<scene::PointLight>(entity);
    }
    void destroy(ecs::Entity entity) {
        registry.destroy(entity);
        std::erase(alive_, entity);
    }
    void edit_surface(ecs::Entity entity, std::uint32_t action) {
        if (action == 4)
            toggle<scene::Material>(entity);
        else if (action == 5)
            toggle<scene::MaterialTextures>(entity, textures());
        else if (action == 6)
            toggle<scene::SurfacePattern>(entity);
        else if (registry.has<scene::Material>(entity))
            registry.patch<scene::Material>(entity, [&](scene::Material& material) {
                material.base_colour.x = some();
                material.emission.y = some();
                material.alpha_mode = scene::AlphaMode(random_() % 2);
            });
    }
    void edit_structure(ecs::Entity entity, std::uint32_t action) {
        if (action == 8)
            toggle<scene::Mover>(entity);
        else if (action == 9)
            registry.emplace_or_replace<scene::Parent>(entity, {alive_[random_() % alive_.size()]});
        else if (action == 10 && registry.has<scene::Parent>(entity))
            registry.remove<scene::Parent>(entity);
        else if (action == 11)
            toggle<scene::MeshInstance>(entity, {number(meshes.size() + 1)});
        else if (action == 12)
            toggle<scene::ShadowCasting>(entity);
        else
            toggle<scene::AreaLight>(entity);
    }
    void edit_place(ecs::Entity entity, std::uint32_t action) {
        if (action == 14)
            meshes.add(triangle(1.0f));
        else if (action == 15)
            meshes.replace(number(meshes.size()), triangle(some()));
        else if (action == 16)
            toggle<scene::PointLight>(entity);
        else if (action == 17 && registry.has<scene::MeshInstance>(entity))
            registry.patch<scene::MeshInstance>(entity,
                                                [&](scene::MeshInstance& mesh) { mesh.mesh = number(meshes.size()); });
        else if (action == 18 && registry.has<scene::WorldTransform>(entity))
            registry.patch<scene::WorldTransform>(entity, [](scene::WorldTransform&) {});
        else if (action == 19)
            toggle<scene::Transform>(entity);
        else if (registry.has<scene::Transform>(entity))
            registry.patch<scene::Transform>(entity, [&](scene::Transform& t) { t.position.x = some(); });
    }

    std::mt19937 random_{7};
    std::vector<ecs::Entity> alive_;
};

} // namespace sunfleck::tests

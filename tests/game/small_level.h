// A walled floor, to which a test adds what it is about, and the game in it.
#pragma once

#include "assets/scene_builder.h"
#include "game_demo/game/game_world.h"
#include "game_demo/game/turning.h"

#include <gtest/gtest.h>

namespace sunfleck::tests {

struct SmallLevel {
    static constexpr float half = 6.0f; // m, of the floor's side

    SmallLevel() : builder(registry, meshes) {
        const scene::Material grey = assets::diffuse(vec3(0.6f));
        builder.box("floor", {-half, -0.2f, -half}, {half, 0.0f, half}, grey);
        builder.box("west wall", {-half - 0.2f, 0.0f, -half}, {-half, 3.0f, half}, grey);
        builder.box("east wall", {half, 0.0f, -half}, {half + 0.2f, 3.0f, half}, grey);
        builder.box("north wall", {-half, 0.0f, -half - 0.2f}, {half, 3.0f, -half}, grey);
        builder.box("south wall", {-half, 0.0f, half}, {half, 3.0f, half + 0.2f}, grey);
        registry.emplace<scene::PlayerStart>(group("start", {0.0f, 0.0f, 4.0f}), {});
    }

    ecs::Entity group(const std::string& name, vec3 position) {
        const ecs::Entity entity = registry.create();
        registry.emplace<scene::Name>(entity, {name});
        scene::Transform transform;
        transform.position = position;
        registry.emplace<scene::Transform>(entity, transform);
        return entity;
    }
    void put_under(ecs::Entity entity, ecs::Entity parent) { registry.emplace<scene::Parent>(entity, {parent}); }
    ecs::Entity box(const std::string& name, vec3 centre, vec3 size) {
        scene::Transform transform;
        transform.position = centre;
        return builder.add(name, scene::make_box(size), assets::diffuse(vec3(0.6f)), transform);
    }
    // A group with a shape and a light below it, as people make it in the editor.
    ecs::Entity lantern(const std::string& name, vec3 foot) {
        const ecs::Entity entity = group(name, foot);
        registry.emplace<scene::Lantern>(entity, {});
        registry.emplace<scene::Mover>(entity, {});
        put_under(box(name + " case", {0.0f, 0.15f, 0.0f}, {0.2f, 0.3f, 0.2f}), entity);
        const ecs::Entity light = group(name + " light", {0.0f, 0.15f, 0.0f});
        registry.emplace<scene::PointLight>(light, {vec3(3.0f)});
        put_under(light, entity);
        return entity;
    }
    ecs::Entity area(const std::string& name, vec3 centre, const scene::GameArea& described) {
        const ecs::Entity entity = group(name, centre);
        registry.emplace<scene::GameArea>(entity, described);
        return entity;
    }

    void begin() {
        scene::update_world_transforms(registry);
        world = demo::GameWorld::create(registry, meshes, nullptr).value();
    }
    void run(std::uint32_t steps, const simulation::StepInput& input = {}) {
        for (std::uint32_t i = 0; i < steps; ++i)
            ASSERT_TRUE(world->step(input));
    }
    void press(std::uint32_t button) {
        simulation::StepInput input;
        input.buttons = button;
        run(1, input);
        run(1);
    }
    void look_at(vec3 target) {
        for (int i = 0; i < 120; ++i) {
            float off = 0.0f;
            run(1, demo::turn_to(person(), target, off));
        }
    }
    // Stands there, looking along -Z.
    void stand_at(vec3 foot) { world->simulation().place_player(foot, vec3(0.0f, 0.0f, -1.0f)); }
    // Takes a lantern from a step away.
    void take(ecs::Entity lantern) {
        const vec3 place = at(lantern);
        stand_at(vec3(place.x, 0.0f, place.z + 1.2f));
        run(10);
        look_at(place + vec3(0.0f, 0.1f, 0.0f));
        press(simulation::button_use);
    }

    const simulation::Character& person() const { return world->simulation().player(); }
    vec3 foot() const { return person().capsule().foot; }
    vec3 at(ecs::Entity entity) const { return vec3(scene::world_matrix(registry, entity)[3]); }
    std::uint64_t hash() { return world->simulation().world_hash(registry); }

    ecs::Registry registry;
    scene::MeshStore meshes;
    assets::SceneBuilder builder;
    std::unique_ptr<demo::GameWorld> world;
};

} // namespace sunfleck::tests

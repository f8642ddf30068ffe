// What can be seen from a place, against hand-made rooms.
#include "game_demo/in_sight.h"

#include "assets/scene_builder.h"

#include <gtest/gtest.h>

namespace sunfleck::demo {
namespace {

struct Corridor {
    Corridor() {
        assets::SceneBuilder s(registry, meshes);
        s.box("wall", vec3(-1.0f, 0.0f, -0.1f), vec3(1.0f, 2.0f, 0.1f), assets::diffuse(vec3(0.5f)));
        thing = s.box("thing", vec3(-0.2f), vec3(0.2f), assets::diffuse(vec3(0.5f)));
        s.mover(thing, {});
    }
    bool sees(vec3 eye, vec3 place) {
        registry.patch<scene::Transform>(thing, [&](scene::Transform& t) { t.position = place; });
        scene::update_world_transforms(registry);
        EXPECT_TRUE(rays->update(registry, meshes));
        return in_sight(*rays, eye, thing, {place - vec3(0.2f), place + vec3(0.2f)});
    }

    ecs::Registry registry;
    scene::MeshStore meshes;
    ecs::Entity thing;
    std::unique_ptr<raytrace::RayScene> rays = raytrace::RayScene::create().value();
};

TEST(InSight, WhatStandsBehindAWallIsNot) {
    Corridor corridor;
    const vec3 eye(0.0f, 1.0f, 3.0f);
    EXPECT_TRUE(corridor.sees(eye, vec3(0.0f, 1.0f, 1.0f))) << "before the wall, itself in the way";
    EXPECT_FALSE(corridor.sees(eye, vec3(0.0f, 1.0f, -1.0f)));
    EXPECT_TRUE(corridor.sees(eye, vec3(1.35f, 1.0f, -1.0f))) << "a part of it looks out from behind";
    EXPECT_TRUE(corridor.sees(eye, vec3(0.0f, 1.0f, 5.0f))) << "behind the eye, in its light";
    EXPECT_TRUE(corridor.sees(vec3(0.0f, 1.0f, -3.0f), vec3(0.0f, 1.0f, -1.0f))) << "from the other side";
}

TEST(InSight, LampsGiveLightAndWallsDoNot) {
    Corridor corridor;
    EXPECT_FALSE(gives_light(corridor.registry, corridor.thing));
    corridor.registry.patch<scene::Material>(corridor.thing, [](scene::Material& m) { m.emission = vec3(1.0f); });
    EXPECT_TRUE(gives_light(corridor.registry, corridor.thing));
    const ecs::Entity lamp = corridor.registry.create();
    EXPECT_FALSE(gives_light(corridor.registry, lamp));
    corridor.registry.emplace<scene::PointLight>(lamp, {});
    EXPECT_TRUE(gives_light(corridor.registry, lamp));
}

} // namespace
} // namespace sunfleck::demo

// A room with lamps of all kinds, for the path tracer and for light tracing.
#pragma once

#include "assets/scene_builder.h"
#include "engine/scene/environment_map.h"
#include "gi_module/reference/light_tracer.h"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

namespace sunfleck::tests {

// A scene that a test describes, and pictures of it from both ends.
struct SceneFromBothEnds {
    ecs::Registry registry;
    scene::MeshStore meshes;
    assets::SceneBuilder builder{registry, meshes};
    std::unique_ptr<raytrace::RayScene> rays;
    std::unique_ptr<gi::reference::PathTracer> from_camera;
    std::unique_ptr<gi::reference::LightTracer> from_light;
    scene::CameraView camera;
    gi::reference::ReferenceSettings settings;

    SceneFromBothEnds() {
        settings.width = 24;
        settings.height = 16;
        settings.view = gi::reference::ReferenceView::irradiance;
        settings.antialiasing = true; // as light tracing has it
    }
    void finish() {
        scene::update_world_transforms(registry);
        rays = raytrace::RayScene::create().value();
        ASSERT_TRUE(rays->update(registry, meshes));
        Bounds bounds;
        registry.view<scene::MeshInstance, scene::WorldTransform>().each(
            [&](ecs::Entity, const scene::MeshInstance& instance, const scene::WorldTransform& world) {
                bounds.add(transform_bounds(world.matrix, meshes.bounds(instance.mesh)));
            });
        const std::vector<gi::Emitter> emitters = gi::collect_emitters(registry, meshes, bounds);
        from_camera = std::make_unique<gi::reference::PathTracer>(*rays, emitters, gi::collect_backgrounds(registry));
        from_light = std::make_unique<gi::reference::LightTracer>(*rays, emitters, gi::collect_backgrounds(registry));
    }
    template <typename Tracer>
    gi::reference::Accumulation picture(const Tracer& tracer, std::uint32_t samples) const {
        gi::reference::Accumulation sums;
        EXPECT_TRUE(tracer.accumulate(sums, camera, settings, samples));
        return sums;
    }
};

inline scene::Material metal(float roughness) {
    scene::Material material;
    material.base_colour = vec3(0.9f, 0.7f, 0.5f);
    material.metallic = 1.0f;
    material.roughness = roughness;
    return material;
}

inline scene::Material clear_glass() {
    scene::Material material;
    material.base_colour = vec3(1.0f);
    material.transmission = 1.0f;
    return material;
}

// A floor, two walls, a metal box, and a coated ball of so few triangles that its shading normals are up to 15 degrees
// off theirs.
inline void furnish(SceneFromBothEnds& scene) {
    assets::SceneBuilder& s = scene.builder;
    s.quad("floor", vec3(-2, 0, 2), vec3(4, 0, 0), vec3(0, 0, -4), assets::diffuse(vec3(0.7f)));
    s.quad("back", vec3(-2, 0, -2), vec3(4, 0, 0), vec3(0, 3, 0), assets::diffuse(vec3(0.6f, 0.6f, 0.7f)));
    s.quad("left", vec3(-2, 0, 2), vec3(0, 0, -4), vec3(0, 3, 0), assets::diffuse(vec3(0.8f, 0.2f, 0.1f)));
    s.box("box", vec3(0.4f, 0, -1.2f), vec3(1.4f, 1.0f, -0.4f), metal(0.35f));
    scene::Material coated = assets::diffuse(vec3(0.5f, 0.6f, 0.3f));
    coated.specular = true;
    coated.roughness = 0.4f;
    scene::Transform place;
    place.position = vec3(-0.7f, 0.6f, 0.1f);
    s.add("ball", scene::make_sphere(0.6f, 12, 6), coated, place);
    scene.camera.position = vec3(0.9f, 2.2f, 3.4f);
    scene.camera.target = vec3(-0.1f, 0.6f, -0.4f);
}

inline scene::Transform aimed(vec3 position, vec3 at) {
    scene::Transform place;
    place.position = position;
    place.rotation = assets::facing(position - at);
    return place;
}

struct Lamp {
    const char* name;
    void (*add)(assets::SceneBuilder&);
};
inline const Lamp lamps[] = {
    {"point", [](assets::SceneBuilder& s) { s.point_light("lamp", vec3(0.3f, 2.3f, 1.2f), vec3(9, 8, 7)); }},
    {"spot",
     [](assets::SceneBuilder& s) {
         s.spot_light("lamp", aimed(vec3(1.2f, 2.5f, 1.5f), vec3(-0.2f, 0.3f, 0)), {vec3(20, 18, 15), 0.3f, 0.6f});
     }},
    {"sun",
     [](assets::SceneBuilder& s) {
         const ecs::Entity sun = s.registry().create();
         s.registry().emplace<scene::DirectionalLight>(sun, {vec3(3, 3, 2)});
         s.registry().emplace<scene::Transform>(sun, aimed(vec3(1, 2, 1.5f), vec3(0)));
     }},
    {"panel", [](assets::SceneBuilder& s) { s.ceiling_light("lamp", vec3(0.2f, 2.4f, 0.4f), 0.8f, 0.6f, vec3(9)); }},
    {"glowing ball",
     [](assets::SceneBuilder& s) {
         scene::Material glow;
         glow.emission = vec3(12, 9, 5);
         s.add("lamp", scene::make_sphere(0.25f, 16, 8), glow, aimed(vec3(0.5f, 1.9f, 0.6f), vec3(0)));
     }},
    {"sky",
     [](assets::SceneBuilder& s) {
         s.registry().emplace<scene::Environment>(s.registry().create(), {vec3(0.6f, 0.7f, 1.0f)});
     }},
    {"picture of a sky",
     [](assets::SceneBuilder& s) {
         std::vector<vec3> texels(16 * 8, vec3(0.3f));
         texels[1 * 16 + 5] = vec3(30, 25, 15);
         const ecs::Entity sky = s.registry().create();
         s.registry().emplace<scene::Environment>(sky, {vec3(1.0f, 0.9f, 0.8f)});
         s.registry().emplace<scene::EnvironmentMap>(
             sky, {"", 0.4f, std::make_shared<const scene::EnvironmentImage>(16u, 8u, std::move(texels))});
     }},
};

} // namespace sunfleck::tests

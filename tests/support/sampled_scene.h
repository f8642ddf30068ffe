// A built-in scene with rays and emitters, for tests of light sampling.
#pragma once

#include "assets/test_rooms.h"
#include "gi_module/light_sampling/light_sampler.h"

#include "engine/raytrace/ray_scene.h"

#include <gtest/gtest.h>

namespace sunfleck::gi {

struct SampledScene {
    explicit SampledScene(void (*make)(assets::SceneBuilder&)) {
        assets::SceneBuilder builder(registry, meshes);
        make(builder);
        finish();
    }
    SampledScene() { scene::register_components(registry); }
    void finish() {
        scene::update_world_transforms(registry);
        rays = raytrace::RayScene::create().value();
        ASSERT_TRUE(rays->update(registry, meshes));
        for (std::uint32_t i = 0; i < meshes.size(); ++i)
            bounds.add(meshes.bounds(i));
        bounds = {};
        registry.view<scene::MeshInstance, scene::WorldTransform>().each(
            [&](ecs::Entity, const scene::MeshInstance& instance, const scene::WorldTransform& world) {
                bounds.add(transform_bounds(world.matrix, meshes.bounds(instance.mesh)));
            });
        emitters = collect_emitters(registry, meshes, bounds);
    }
    ecs::Registry registry;
    scene::MeshStore meshes;
    std::unique_ptr<raytrace::RayScene> rays;
    Bounds bounds;
    std::vector<Emitter> emitters;
};

inline double total_luminance(const std::vector<LightSample>& samples) {
    double sum = 0;
    for (const LightSample& sample : samples)
        sum += double(luminance(sample.flux));
    return sum;
}

} // namespace sunfleck::gi

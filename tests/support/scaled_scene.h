// The same scene in another unit and at another place.
#pragma once

#include "tests/support/gpu_world.h"

#include "engine/scene/simulation_components.h"

namespace sunfleck::tests {

// Multiplies all lengths by `scale`, then moves everything. Strengths of point and spot lights follow, so that the
// light that arrives is the same.
inline void scale_scene(ecs::Registry& registry, float scale, vec3 moved = vec3(0.0f)) {
    using namespace scene;
    registry.view<Transform>().each([&](ecs::Entity entity, Transform transform) {
        if (registry.has<Parent>(entity)) // in its parent's units
            return;
        transform.scale *= scale;
        transform.position = transform.position * scale + moved;
        registry.update<Transform>(entity, transform);
    });
    registry.view<Mover>().each([&](ecs::Entity entity, Mover mover) {
        if (registry.has<Parent>(entity))
            return;
        mover.travel *= scale;
        mover.centre = mover.centre * scale + moved;
        mover.reach *= scale;
        registry.emplace_or_replace<Mover>(entity, mover);
    });
    registry.view<PointLight>().each([&](ecs::Entity entity, PointLight light) {
        light.intensity *= scale * scale;
        registry.update<PointLight>(entity, light);
    });
    registry.view<SpotLight>().each([&](ecs::Entity entity, SpotLight light) {
        light.intensity *= scale * scale;
        registry.update<SpotLight>(entity, light);
    });
}

struct ScaledWorld : GpuWorld {
    ScaledWorld(void (*make)(assets::SceneBuilder&), float scale, vec3 moved = vec3(0.0f)) {
        {
            assets::SceneBuilder builder(renderer->registry(), renderer->meshes());
            make(builder);
        }
        finish();
        scale_scene(renderer->registry(), scale, moved);
        scene::update_world_transforms(renderer->registry());
        request.camera.position = request.camera.position * scale + moved;
        request.camera.target = request.camera.target * scale + moved;
    }
};

} // namespace sunfleck::tests

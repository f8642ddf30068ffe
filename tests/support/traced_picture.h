// The path tracer's picture of what a GpuWorld shows.
#pragma once

#include "tests/support/gpu_world.h"

#include "gi_module/reference/path_tracer.h"

namespace sunfleck::tests {

// Sums over `paths` a pixel, the same random numbers each time.
inline gi::reference::Accumulation trace_picture(GpuWorld& world, gi::reference::ReferenceView view,
                                                 std::uint32_t paths) {
    ecs::Registry& registry = world.renderer->registry();
    const scene::MeshStore& meshes = world.renderer->meshes();
    const auto rays = raytrace::RayScene::create().value();
    EXPECT_TRUE(rays->update(registry, meshes));
    const gi::reference::PathTracer tracer(
        *rays, gi::collect_emitters(registry, meshes, viewer::scene_bounds(registry, meshes)));
    gi::reference::ReferenceSettings settings;
    settings.width = world.request.width;
    settings.height = world.request.height;
    settings.view = view;
    gi::reference::Accumulation sums;
    tracer.accumulate(sums, world.request.camera, settings, paths, {});
    return sums;
}

} // namespace sunfleck::tests

// What becomes of a file that nobody should trust, all the way that it goes: import, surface patches, Embree, a sample
// of the path tracer, and steps of the simulation and of light sensors. It is refused with a message, or gives finite
// light.
#pragma once

#include "engine/scene/deformation.h"
#include "engine/scene/scene_space.h"
#include "engine/simulation/simulation.h"
#include "gi_module/light_sampling/emitters.h"
#include "gi_module/light_sensors/light_sensors.h"
#include "gi_module/reference/path_tracer.h"
#include "gi_module/visibility/surface_patches.h"
#include "tests/support/mutated_files.h"
#include "viewer/scene_renderer.h"

#include <chrono>
#include <cmath>
#include <functional>
#include <sys/resource.h>

namespace sunfleck::tests {

struct FileCounts {
    int tried = 0, refused = 0, right = 0, wrong = 0;
    double slowest = 0.0; // s
    ~FileCounts() {
        std::printf("%d tried, %d refused, %d right, %d wrong; the slowest took %.2f s, at most %ld MB\n", tried,
                    refused, right, wrong, slowest, most_megabytes());
    }
    // Of this process until now.
    static long most_megabytes() {
        rusage usage{};
        getrusage(RUSAGE_SELF, &usage);
        return usage.ru_maxrss / 1024;
    }
};

// Everything that is made of a scene before its first frame, without a GPU, and one sample of 8x8 pixels.
inline Status trace(World& world) {
    viewer::add_default_light(world.registry);
    scene::deform_meshes(world.registry, world.meshes);
    SUNFLECK_ASSIGN(const auto rays, raytrace::RayScene::create());
    SUNFLECK_TRY(rays->update(world.registry, world.meshes, &world.textures));
    const Bounds bounds = viewer::scene_bounds(world.registry, world.meshes);
    SUNFLECK_ASSIGN(const scene::CameraView camera, viewer::find_camera(world.registry, bounds, ""));
    gi::StaticBlockers blockers;
    gi::SurfacePatches patches;
    gi::PatchOptions options;
    std::vector<scene::PlacedMesh> geometry;
    world.registry.view<scene::MeshInstance, scene::WorldTransform>().each(
        [&](ecs::Entity, const scene::MeshInstance& instance, const scene::WorldTransform& place) {
            geometry.push_back({instance.mesh, place.matrix});
        });
    options.space = scene::space_of(geometry, world.meshes);
    patches.build(world.registry, world.meshes, options, blockers);
    const gi::reference::PathTracer tracer(*rays, gi::collect_emitters(world.registry, world.meshes, bounds),
                                           gi::collect_backgrounds(world.registry));
    gi::reference::ReferenceSettings settings;
    settings.width = settings.height = 8;
    gi::reference::Accumulation picture;
    tracer.accumulate(picture, camera, settings, 1);
    for (const double sum : picture.sums)
        if (!std::isfinite(sum) || sum < 0.0)
            return Error{"light that is not finite", ErrorCode::stopped};
    return {};
}

// Two steps of all that moves, with a person who walks and uses what they see, and of light sensors where there are
// any.
inline Status simulate(World& world) {
    simulation::Simulation simulation(world.registry, world.meshes);
    std::unique_ptr<gi::LightSensors> sensors;
    if (world.registry.count<scene::LightSensor>() > 0) {
        SUNFLECK_ASSIGN(sensors, gi::LightSensors::create());
    }
    bool finite = true;
    for (int step = 0; step < 2; ++step) {
        simulation.step(world.registry, {100, 0, 0, 0, simulation::button_use});
        scene::deform_meshes(world.registry, world.meshes);
        if (sensors)
            SUNFLECK_TRY(sensors->step(world.registry, world.meshes, &world.textures));
        finite = finite && is_finite(simulation.player().eye());
    }
    world.registry.view<scene::Transform>().each([&](ecs::Entity, const scene::Transform& place) {
        finite = finite && is_finite(place.position) && is_finite(place.scale) && std::isfinite(place.rotation.w) &&
                 is_finite(vec3(place.rotation.x, place.rotation.y, place.rotation.z));
    });
    world.registry.view<scene::SensorReading>().each([&](ecs::Entity, const scene::SensorReading& reading) {
        finite = finite && is_finite(reading.irradiance) && std::isfinite(reading.share);
    });
    return finite ? Status() : Status(Error{"a step to where nothing is finite", ErrorCode::stopped});
}

// A refused file has left nothing behind and says why.
inline void judge(FileCounts& counts, const std::string& what, const std::function<Status(World&)>& import) {
    World world;
    ++counts.tried;
    const auto start = std::chrono::steady_clock::now();
    Status status = import(world);
    const bool imported = bool(status);
    bool right = imported || (world.registry.entity_count() == 0 && !status.error().message.empty());
    if (imported) {
        expect_sound(world, what);
        status = trace(world);
        if (status)
            status = simulate(world);
        right = status || status.error().code != ErrorCode::stopped;
    }
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    counts.slowest = std::max(counts.slowest, seconds.count());
    EXPECT_LT(seconds.count(), 20.0) << what;
    EXPECT_TRUE(right) << what << ": " << (status ? "" : status.error().message);
    (!right ? counts.wrong : status ? counts.right : counts.refused) += 1;
}

inline void judge_bytes(FileCounts& counts, const std::string& what, const std::string& bytes) {
    judge(counts, what, [&](World& world) {
        const auto report = world.import(bytes);
        return report ? Status() : Status(report.error());
    });
}

// The seeds that bench.sh asks for, which are 1 to 20,000 in all; `by_default` where it doesn't.
struct Seeds {
    std::uint32_t first = 1, last = 0;
    bool given = false;
};
inline Seeds seeds_to_try(std::uint32_t by_default) {
    const char *const first = std::getenv("SUNFLECK_FIRST_SEED"), *const last = std::getenv("SUNFLECK_LAST_SEED");
    if (first == nullptr || last == nullptr)
        return {1, by_default, false};
    return {std::uint32_t(std::strtoul(first, nullptr, 10)), std::uint32_t(std::strtoul(last, nullptr, 10)), true};
}

} // namespace sunfleck::tests

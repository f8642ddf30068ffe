#include "assets/test_rooms.h"
#include "gi_module/reference/accumulation_file.h"
#include "gi_module/reference/bsdf.h"
#include "gi_module/reference/path_tracer.h"

#include "engine/core/jobs.h"
#include "engine/core/random.h"

#include <gtest/gtest.h>

#include <atomic>
#include <numeric>

namespace sunfleck::gi::reference {
namespace {

// Irradiance / pi in a closed furnace of albedo a and emission e: e (1 - a^(B+1)) / (1 - a).
double furnace(double a, double e, std::uint32_t bounces) {
    if (bounces == unlimited_bounces)
        return e / (1.0 - a);
    double sum = 0, power = e;
    for (std::uint32_t k = 0; k <= bounces; ++k, power *= a)
        sum += power;
    return sum;
}

TEST(Reference, SavingTakesTwoPerCentAtMost) {
    SaveClock often(0.2);
    EXPECT_EQ(often.next(), 0.2);
    for (const double seconds : {0.001, 0.1, 7.0}) {
        often.saved(seconds);
        EXPECT_LE(seconds / (seconds + often.next()), 0.02 + 1e-12);
        EXPECT_GE(often.next(), 0.2);
    }
    EXPECT_FALSE(often.is_time());
}

TEST(Reference, FurnaceHasItsClosedForm) {
    for (const float albedo : {0.1f, 0.3f, 0.5f, 0.7f, 0.9f}) {
        ecs::Registry registry;
        scene::MeshStore meshes;
        assets::SceneBuilder builder(registry, meshes);
        assets::make_furnace_of(builder, albedo, 1.5f);
        scene::update_world_transforms(registry);
        const auto rays = raytrace::RayScene::create().value();
        ASSERT_TRUE(rays->update(registry, meshes));
        const PathTracer tracer(*rays, collect_emitters(registry, meshes, meshes.bounds(0)));
        scene::CameraView camera;
        camera.position = vec3(0.3f, -0.2f, 0.4f);
        camera.target = vec3(-0.5f, 0.1f, -1.0f);
        for (const std::uint32_t bounces : {0u, 1u, 5u, unlimited_bounces}) {
            ReferenceSettings settings;
            settings.width = 16;
            settings.height = 9;
            settings.bounces = bounces;
            settings.view = ReferenceView::irradiance;
            Accumulation accumulation;
            ASSERT_TRUE(tracer.accumulate(accumulation, camera, settings, 256));
            double mean = 0;
            for (const double sum : accumulation.sums)
                mean += sum / double(accumulation.sums.size()) / accumulation.samples;
            const double expected = furnace(double(albedo), 1.5, bounces);
            EXPECT_NEAR(mean / 3.14159265358979 / expected, 1.0, 0.005)
                << "albedo " << albedo << " bounces " << bounces;
        }
    }
}

struct Room {
    explicit Room(void (*make)(assets::SceneBuilder&) = assets::make_cornell) {
        assets::SceneBuilder builder(registry, meshes);
        make(builder);
        scene::update_world_transforms(registry);
        rays = raytrace::RayScene::create().value();
        EXPECT_TRUE(rays->update(registry, meshes));
        Bounds bounds;
        bounds.add(vec3(0.0f));
        bounds.add(vec3(5.6f));
        tracer = std::make_unique<PathTracer>(*rays, collect_emitters(registry, meshes, bounds));
        camera.position = vec3(2.78f, 2.73f, 13.3f);
        camera.target = vec3(2.78f, 2.73f, 2.8f);
        camera.vertical_field_of_view = 0.68f;
        settings.width = 24;
        settings.height = 18;
    }
    ecs::Registry registry;
    scene::MeshStore meshes;
    std::unique_ptr<raytrace::RayScene> rays;
    std::unique_ptr<PathTracer> tracer;
    scene::CameraView camera;
    ReferenceSettings settings;
};

TEST(Reference, SameBitsForOneAndTwoThreadsAndForAnySplitOfTheWork) {
    const Room room;
    Accumulation one, two, split;
    {
        const ThreadLimit limit(1);
        ASSERT_TRUE(room.tracer->accumulate(one, room.camera, room.settings, 12));
    }
    ASSERT_TRUE(room.tracer->accumulate(two, room.camera, room.settings, 12));
    ASSERT_TRUE(room.tracer->accumulate(split, room.camera, room.settings, 5));
    const std::string file = testing::TempDir() + "/sunfleck_state";
    ASSERT_TRUE(SavedAccumulation(file, 42).save(split));
    EXPECT_FALSE(SavedAccumulation(file, 43).load());
    auto resumed = SavedAccumulation(file, 42).load();
    ASSERT_TRUE(resumed);
    ASSERT_TRUE(room.tracer->accumulate(*resumed, room.camera, room.settings, 7));
    SavedAccumulation(file, 42).remove();
    EXPECT_EQ(one.sums, two.sums);
    EXPECT_EQ(one.sums, resumed->sums);
    EXPECT_EQ(one.rays, resumed->rays);
}

// Wherever it is stopped, all that was traced counts, and goes on to the same bits.
TEST(Reference, StoppedAnywhereItGoesOnToTheSameBits) {
    const Room room;
    Accumulation whole, stopped;
    ASSERT_TRUE(room.tracer->accumulate(whole, room.camera, room.settings, 9));
    ASSERT_TRUE(room.tracer->accumulate(stopped, room.camera, room.settings, 2));
    const std::uint64_t before = stopped.rays;
    EXPECT_FALSE(room.tracer->accumulate(stopped, room.camera, room.settings, 7, [] { return true; }));
    EXPECT_GT(stopped.rays, before) << "what was traced is kept";
    EXPECT_EQ(stopped.samples, 2u);
    int stops = 0;
    for (std::atomic<int> pixels{0}; stops < 1000; ++stops)
        if (room.tracer->accumulate(stopped, room.camera, room.settings, 7, [&] { return ++pixels % 40 == 0; }))
            break;
    EXPECT_GT(stops, 5);
    EXPECT_EQ(stopped.sums, whole.sums);
    EXPECT_EQ(stopped.rays, whole.rays);
    EXPECT_EQ(stopped.counts, whole.counts);
    EXPECT_EQ(stopped.samples, 9u);
}

TEST(Reference, DirectAndIndirectAddUpToIrradiance) {
    Room room;
    double means[3] = {};
    const ReferenceView views[] = {ReferenceView::direct, ReferenceView::indirect, ReferenceView::irradiance};
    for (int i = 0; i < 3; ++i) {
        room.settings.view = views[i];
        Accumulation accumulation;
        ASSERT_TRUE(room.tracer->accumulate(accumulation, room.camera, room.settings, 64));
        for (const double sum : accumulation.sums)
            means[i] += sum;
    }
    EXPECT_NEAR((means[0] + means[1]) / means[2], 1.0, 1e-6);
    EXPECT_GT(means[1], 0.1 * means[2]);
}

// Sums of a room's picture with caustics and without.
std::pair<Accumulation, Accumulation> with_and_without_caustics(Room& room, std::uint32_t samples) {
    std::pair<Accumulation, Accumulation> result;
    room.settings.caustics = true;
    EXPECT_TRUE(room.tracer->accumulate(result.first, room.camera, room.settings, samples));
    room.settings.caustics = false;
    EXPECT_TRUE(room.tracer->accumulate(result.second, room.camera, room.settings, samples));
    return result;
}

double total(const Accumulation& accumulation) {
    return std::accumulate(accumulation.sums.begin(), accumulation.sums.end(), 0.0);
}

// A metal ring throws light on the floor by way of its gloss; without caustics that is missing, and all else is there.
TEST(Reference, CausticsAreWhatGlossThrowsOnDiffuseSurfaces) {
    Room ring(assets::make_ring);
    ring.camera.position = vec3(0.0f, 1.0f, 1.2f);
    ring.camera.target = vec3(0.0f);
    ring.settings.view = ReferenceView::irradiance;
    ring.settings.bounces = 1;
    const auto [with, without] = with_and_without_caustics(ring, 256);
    // The same random numbers, so that each path finds the same or less.
    for (std::size_t i = 0; i < with.sums.size(); ++i)
        ASSERT_LE(without.sums[i], with.sums[i] * (1.0 + 1e-6)) << i;
    EXPECT_LT(total(without), 0.999 * total(with));
    EXPECT_GT(total(without), 0.5 * total(with));
    // Light straight from emitters is none.
    ring.settings.view = ReferenceView::direct;
    const auto [direct, direct_without] = with_and_without_caustics(ring, 4);
    EXPECT_EQ(direct.sums, direct_without.sums);
}

TEST(Reference, MatteSurfacesThrowNoCaustics) {
    Room room;
    room.registry.view<scene::Material>().each(
        [](ecs::Entity, const scene::Material& material) { EXPECT_FALSE(material.specular); });
    const auto [with, without] = with_and_without_caustics(room, 8);
    for (std::size_t i = 0; i < with.sums.size(); ++i) // the order of products differs
        EXPECT_NEAR(without.sums[i], with.sums[i], 1e-5 * (1.0 + with.sums[i])) << i;
}

TEST(Bsdf, FresnelOfGlassHasItsKnownValues) {
    EXPECT_NEAR(fresnel_dielectric(1.0f, 1.5f), 0.04f, 1e-6f);
    EXPECT_NEAR(fresnel_dielectric(0.0f, 1.5f), 1.0f, 1e-5f);
    EXPECT_EQ(fresnel_dielectric(0.5f, 1.0f / 1.5f), 1.0f); // total reflection
    // Brewster's angle: only the perpendicular part is reflected.
    const float brewster = std::cos(std::atan(1.5f));
    EXPECT_NEAR(fresnel_dielectric(brewster, 1.5f), 0.5f * std::pow((1.5f * 1.5f - 1.0f) / (1.5f * 1.5f + 1.0f), 2.0f),
                1e-4f);
}

// A glass ball in a uniform surrounding takes nothing away: its pixels show the surroundings' radiance.
TEST(Reference, AGlassBallInAUniformSkyIsInvisible) {
    ecs::Registry registry;
    scene::MeshStore meshes;
    assets::SceneBuilder builder(registry, meshes);
    scene::Material glass;
    glass.base_colour = vec3(1.0f);
    glass.transmission = 1.0f;
    builder.add("ball", scene::make_sphere(1.0f), glass);
    registry.emplace<scene::Environment>(registry.create(), {vec3(2.0f)});
    scene::update_world_transforms(registry);
    const auto rays = raytrace::RayScene::create().value();
    ASSERT_TRUE(rays->update(registry, meshes));
    const PathTracer tracer(*rays, collect_emitters(registry, meshes, meshes.bounds(0)));
    scene::CameraView camera;
    camera.position = vec3(0.0f, 0.0f, 4.0f);
    camera.target = vec3(0.0f);
    ReferenceSettings settings;
    settings.width = settings.height = 16;
    settings.bounces = 64;
    Accumulation accumulation;
    ASSERT_TRUE(tracer.accumulate(accumulation, camera, settings, 64));
    for (const double sum : accumulation.sums)
        EXPECT_NEAR(sum / 64, 2.0, 0.02);
}

// A scene that a test describes, and what a path tracer finds in it.
struct Traced {
    ecs::Registry registry;
    scene::MeshStore meshes;
    assets::SceneBuilder builder{registry, meshes};
    std::unique_ptr<raytrace::RayScene> rays;
    std::unique_ptr<PathTracer> tracer;

    void finish() {
        scene::update_world_transforms(registry);
        rays = raytrace::RayScene::create().value();
        ASSERT_TRUE(rays->update(registry, meshes));
        Bounds bounds;
        registry.view<scene::MeshInstance, scene::WorldTransform>().each(
            [&](ecs::Entity, const scene::MeshInstance& instance, const scene::WorldTransform& world) {
                bounds.add(transform_bounds(world.matrix, meshes.bounds(instance.mesh)));
            });
        tracer = std::make_unique<PathTracer>(*rays, collect_emitters(registry, meshes, bounds),
                                              collect_backgrounds(registry));
    }
    vec3 direct(vec3 position, vec3 normal, std::uint32_t samples, std::uint32_t seed) const {
        return tracer->irradiance_by_bounce(position, normal, 0, samples, seed)[0];
    }
    Accumulation picture(vec3 from, vec3 to, ReferenceView view, std::uint32_t samples) const {
        scene::CameraView camera;
        camera.position = from;
        camera.target = to;
        ReferenceSettings settings;
        settings.width = settings.height = 8;
        settings.view = view;
        Accumulation accumulation;
        EXPECT_TRUE(tracer->accumulate(accumulation, camera, settings, samples));
        return accumulation;
    }
};

// Light passes what casts no shadow, whether it is sought (a shadow ray) or found (a scattered ray), and the camera
// sees it.
TEST(Reference, LightPassesWhatCastsNoShadow) {
    for (const bool casts : {true, false}) {
        Traced scene;
        scene.builder.quad("floor", vec3(-5, 0, 5), vec3(10, 0, 0), vec3(0, 0, -10), assets::diffuse(vec3(0.5f)));
        scene.builder.ceiling_light("lamp", vec3(0, 3, 0), 1.0f, 1.0f, vec3(10.0f));
        const ecs::Entity shade =
            scene.builder.box("shade", vec3(-1, 1.9f, -1), vec3(1, 2.0f, 1), assets::diffuse(vec3(0.7f, 0.1f, 0.1f)));
        scene.builder.mover(shade, {});
        if (!casts)
            scene.registry.emplace<scene::ShadowCasting>(shade, {false});
        scene.finish();
        // A square of 1 m2 at 3 m, both horizontal: E = L A / d2, less 3 % for its size.
        const float lit = scene.direct(vec3(0.0f), vec3(0, 1, 0), 1024, 1).x;
        EXPECT_NEAR(lit, casts ? 0.0f : 10.0f / 9.0f, casts ? 0.0f : 0.06f);
        const Accumulation seen = scene.picture(vec3(0, 2.5f, 0.5f), vec3(0, 2, 0), ReferenceView::radiance, 64);
        EXPECT_GT(seen.sums[0], 3.0 * seen.sums[1]) << "the shade is red";
    }
}

// A sky that is only seen is in pictures and lights nothing.
TEST(Reference, BackgroundsAreSeenAndLightNothing) {
    Traced scene;
    scene.builder.quad("floor", vec3(-5, 0, 5), vec3(10, 0, 0), vec3(0, 0, -10), assets::diffuse(vec3(0.5f)));
    scene.registry.emplace<scene::Environment>(scene.registry.create(), {vec3(2.0f), false});
    scene.finish();
    EXPECT_EQ(scene.direct(vec3(0.0f), vec3(0, 1, 0), 64, 1), vec3(0.0f));
    for (const double sum : scene.picture(vec3(0, 1, 0), vec3(0, 5, -1), ReferenceView::radiance, 4).sums)
        EXPECT_EQ(sum, 4.0 * 2.0);
}

// A small lamp near a receiver lights it nearly alone, although a lamp with 10,000 times its flux shines behind a wall:
// chosen by flux, it would be found by one of 10,000 samples.
TEST(Reference, ANearLampIsNotLeftToChance) {
    Traced scene;
    scene.builder.box("wall", vec3(2.0f, -50, -50), vec3(2.2f, 50, 50), assets::diffuse(vec3(0.5f)));
    scene.builder.point_light("far", vec3(40, 0, 0), vec3(10000.0f));
    scene.builder.point_light("near", vec3(0, 0.5f, 0), vec3(1.0f));
    scene.finish();
    const double truth = 4.0; // I / d2
    double squares = 0.0;
    constexpr std::uint32_t seeds = 32;
    for (std::uint32_t seed = 0; seed < seeds; ++seed) {
        const double error = double(scene.direct(vec3(0.0f), vec3(0, 1, 0), 64, seed).x) / truth - 1.0;
        squares += error * error / seeds;
    }
    EXPECT_LT(std::sqrt(squares), 0.3); // 64 samples, each with a chance of a fifth; by flux: 12
}

// The same room at any size and place: no ray meets the surface that it leaves, none passes a wall, and the light is
// the same as long as the lamp's radiance is.
TEST(Reference, AnyScaleAndPlaceGivesTheSameLight) {
    const auto room = [](float scale, vec3 place, ReferenceView view) {
        Traced scene;
        const vec3 white(0.7f), low = place - scale * vec3(2, 1.2f, 2), high = place + scale * vec3(2, 1.2f, 2);
        scene.builder.room(low, high, white, white, {white, white, white, white},
                           {{"lamp", vec2(place.x, place.z), scale, scale, vec3(5.0f)}});
        scene.builder.box("box", place + scale * vec3(-1, -1.2f, -1), place + scale * vec3(-0.4f, -0.2f, -0.4f),
                          assets::diffuse(white));
        scene.finish();
        return scene.picture(place + scale * vec3(1.5f, 0.3f, 1.5f), place - scale * vec3(0.5f, 0.5f, 0.5f), view, 256);
    };
    const auto mean = [](const Accumulation& picture) {
        double sum = 0.0;
        for (const double value : picture.sums)
            sum += value / double(picture.sums.size()) / picture.samples;
        return sum;
    };
    const double unscaled = mean(room(1.0f, vec3(0.0f), ReferenceView::irradiance));
    for (const float scale : {0.01f, 0.1f, 10.0f, 100.0f, 1000.0f})
        EXPECT_NEAR(mean(room(scale, vec3(0.0f), ReferenceView::irradiance)) / unscaled, 1.0, 0.003) << scale;
    for (const float scale : {0.01f, 1.0f, 100.0f})
        EXPECT_NEAR(mean(room(scale, scale * vec3(400, 20, -300), ReferenceView::irradiance)) / unscaled, 1.0, 0.003)
            << scale << ", moved";
}

} // namespace
} // namespace sunfleck::gi::reference

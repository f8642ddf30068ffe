#include "assets/test_rooms.h"
#include "gi_module/reference/bsdf.h"
#include "gi_module/reference/path_tracer.h"

#include "engine/core/jobs.h"
#include "engine/core/random.h"

#include <gtest/gtest.h>

#include <cstdio>

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
    Room() {
        assets::SceneBuilder builder(registry, meshes);
        assets::make_cornell(builder);
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
    ASSERT_TRUE(save_accumulation(file, split, 42));
    EXPECT_FALSE(load_accumulation(file, 43));
    auto resumed = load_accumulation(file, 42);
    ASSERT_TRUE(resumed);
    ASSERT_TRUE(room.tracer->accumulate(*resumed, room.camera, room.settings, 7));
    std::remove(file.c_str());
    EXPECT_EQ(one.sums, two.sums);
    EXPECT_EQ(one.sums, resumed->sums);
    EXPECT_EQ(one.rays, resumed->rays);
}

TEST(Reference, CancellingChangesNothing) {
    const Room room;
    Accumulation accumulation;
    ASSERT_TRUE(room.tracer->accumulate(accumulation, room.camera, room.settings, 2));
    const std::vector<double> before = accumulation.sums;
    EXPECT_FALSE(room.tracer->accumulate(accumulation, room.camera, room.settings, 50, [] { return true; }));
    EXPECT_EQ(accumulation.sums, before);
    EXPECT_EQ(accumulation.samples, 2u);
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

// The density integrates to what sample() does: a Monte Carlo estimate of the albedo by sampling the BSDF agrees with
// one by uniform directions, and no surface reflects more than it receives.
TEST(Bsdf, SamplingAgreesWithEvaluationAndEnergyIsConserved) {
    for (const float roughness : {0.2f, 0.5f, 1.0f})
        for (const float metallic : {0.0f, 1.0f})
            for (const bool specular : {false, true})
                for (const float cosine : {0.2f, 0.7f, 1.0f}) {
                    scene::Material material;
                    material.base_colour = vec3(0.9f, 0.5f, 0.1f);
                    material.roughness = roughness;
                    material.metallic = metallic;
                    material.specular = specular;
                    const Bsdf bsdf(material);
                    const vec3 outgoing(std::sqrt(1.0f - cosine * cosine), 0.0f, cosine);
                    double sampled = 0, uniform = 0, density = 0;
                    const int count = 1 << 16;
                    for (int i = 0; i < count; ++i) {
                        const RandomSequence random(SequenceKind::sobol, 1, std::uint32_t(i));
                        const float numbers[3] = {random.at(0), random.at(1), random.at(2)};
                        BsdfSample result;
                        if (bsdf.sample(outgoing, numbers, result) && result.direction.z > 0.0f)
                            sampled += double(result.weight.x) / count;
                        const vec3 direction = [&] {
                            const float z = random.at(0), angle = 2.0f * pi * random.at(1);
                            const float r = std::sqrt(1.0f - z * z);
                            return vec3(r * std::cos(angle), r * std::sin(angle), z);
                        }();
                        uniform +=
                            double(bsdf.evaluate(outgoing, direction).x * direction.z) * 2.0 * double(pi) / count;
                        density += double(bsdf.density(outgoing, direction)) * 2.0 * double(pi) / count;
                    }
                    EXPECT_NEAR(sampled, uniform, 0.01) << roughness << metallic << specular << cosine;
                    EXPECT_LE(sampled, 1.001);
                    EXPECT_LE(density, 1.01); // what is missing points below the surface
                    // Reciprocity.
                    const vec3 other = glm::normalize(vec3(-0.3f, 0.4f, 0.6f));
                    EXPECT_NEAR(bsdf.evaluate(outgoing, other).y, bsdf.evaluate(other, outgoing).y, 1e-4f);
                }
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

} // namespace
} // namespace sunfleck::gi::reference

// Samples of lights that move, against samples generated at the new place.
#include "assets/test_rooms.h"
#include "gi_module/light_sampling/dynamic_lights.h"
#include "gi_module/light_sampling/light_sampler.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

namespace sunfleck::gi {
namespace {

struct World {
    World() {
        assets::SceneBuilder builder(registry, meshes);
        assets::make_four_pillars(builder);
        for (const EmitterKind kind : {EmitterKind::point, EmitterKind::spot, EmitterKind::rectangle})
            lights.push_back(make(builder, kind));
        follow();
    }
    ecs::Entity make(assets::SceneBuilder& builder, EmitterKind kind) {
        if (kind == EmitterKind::rectangle) {
            const ecs::Entity lamp = builder.area_light("panel", {}, {});
            builder.mover(lamp, {});
            return lamp;
        }
        const ecs::Entity light = registry.create();
        registry.emplace<scene::Transform>(light, {vec3(0.4f, 1.5f, 0.2f)});
        registry.emplace<scene::Mover>(light, {});
        if (kind == EmitterKind::point)
            registry.emplace<scene::PointLight>(light, {vec3(3.0f, 2.0f, 1.0f)});
        else
            registry.emplace<scene::SpotLight>(light, {vec3(9.0f), 0.4f, 0.9f});
        return light;
    }
    void place(std::mt19937& random, float step) {
        std::uniform_real_distribution<float> by(-step, step);
        for (const ecs::Entity light : lights)
            registry.patch<scene::Transform>(light, [&](scene::Transform& t) {
                t.position = glm::clamp(t.position + vec3(by(random), by(random), by(random)), vec3(-1.2f, 0.5f, -1.2f),
                                        vec3(1.2f, 2.5f, 1.2f));
                t.rotation = glm::normalize(glm::angleAxis(by(random), vec3(0.6f, 0.0f, 0.8f)) * t.rotation);
            });
        follow();
    }
    void follow() {
        scene::update_world_transforms(registry);
        if (!rays)
            rays = raytrace::RayScene::create().value();
        ASSERT_TRUE(rays->update(registry, meshes));
        emitters.clear();
        for (const Emitter& emitter : collect_emitters(registry, meshes, {vec3(-4, 0, -4), vec3(4, 3.5f, 4)}))
            if (emitter.moves)
                emitters.push_back(emitter);
    }
    ecs::Registry registry;
    scene::MeshStore meshes;
    std::vector<ecs::Entity> lights;
    std::unique_ptr<raytrace::RayScene> rays;
    std::vector<Emitter> emitters;
};

// Luminance of the flux of one emitter's samples.
double flux_of(const std::vector<LightSample>& samples, ecs::Entity emitter, bool direct) {
    double sum = 0;
    for (const LightSample& sample : samples)
        if (sample.emitter == emitter && (sample.bounce == 0) == direct)
            sum += double(luminance(sample.flux));
    return sum;
}

TEST(DynamicLights, CarryTheFluxOfPlainWalks) {
    World world;
    SampleRequest settings;
    settings.candidates = 1;
    settings.bounces = 4;
    // 40 moves of up to 5 cm: most paths stay, and what is left must be worth as much as fresh walks.
    std::map<EmitterKind, double> ratio;
    constexpr int seeds = 8;
    for (std::uint32_t seed = 0; seed < seeds; ++seed) {
        std::mt19937 random(11 + seed);
        settings.seed = seed;
        DynamicLights lights;
        lights.reset(world.emitters, 1000, settings, *world.rays);
        ASSERT_EQ(world.emitters.size(), 3u);
        for (int move = 0; move < 40; ++move) {
            world.place(random, 0.05f);
            lights.update(world.emitters, *world.rays);
        }
        for (const Emitter& emitter : world.emitters) {
            const auto fresh = sample_indirect({emitter}, 20000, settings, *world.rays);
            double expected = 0;
            for (const LightSample& sample : fresh)
                expected += double(luminance(sample.flux));
            ratio[emitter.kind] += flux_of(lights.samples(), emitter.entity, false) / expected / seeds;
            // Point and area samples carry their emitter's flux; a spot sample holds its intensity instead.
            if (emitter.kind != EmitterKind::spot) {
                EXPECT_NEAR(flux_of(lights.samples(), emitter.entity, true) / double(luminance(emitter.flux)), 1.0,
                            1e-5);
            }
        }
    }
    // Some 2,000 paths in all whose worth varies by about its mean: 2 % is one standard error, and paths were chosen
    // for older places.
    for (const auto& [kind, mean] : ratio)
        EXPECT_NEAR(mean, 1.0, 0.06) << int(kind);
}

TEST(DynamicLights, KeepWhatTheyStillSee) {
    World world;
    std::mt19937 random(5);
    DynamicLights lights;
    lights.reset(world.emitters, 60, {}, *world.rays);
    std::size_t kept = 0, all = 0;
    for (int move = 0; move < 200; ++move) {
        const std::vector<LightSample> before = lights.samples();
        world.place(random, 0.03f);
        lights.update(world.emitters, *world.rays);
        EXPECT_LE(lights.resampled(), 4u * 3u);
        for (std::size_t i = 0; i < before.size(); ++i) {
            if (before[i].bounce == 0)
                continue;
            const bool same = before[i].position == lights.samples()[i].position;
            EXPECT_NE(same, lights.moved()[i] != 0);
            kept += same;
            ++all;
        }
    }
    EXPECT_GT(double(kept) / double(all), 0.9);
}

TEST(DynamicLights, StrengthOnlyScales) {
    World world;
    DynamicLights lights;
    lights.reset(world.emitters, 60, {}, *world.rays);
    const std::vector<LightSample> before = lights.samples();
    for (Emitter& emitter : world.emitters) {
        emitter.flux *= vec3(0.5f, 2.0f, 0.0f);
        emitter.intensity *= vec3(0.5f, 2.0f, 0.0f);
        emitter.radiance *= vec3(0.5f, 2.0f, 0.0f);
    }
    lights.update(world.emitters, *world.rays);
    EXPECT_EQ(lights.resampled(), 0u);
    for (std::size_t i = 0; i < before.size(); ++i) {
        EXPECT_EQ(lights.moved()[i], 0);
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(lights.samples()[i].flux[c], before[i].flux[c] * vec3(0.5f, 2.0f, 0.0f)[c],
                        1e-5f * before[i].flux[c]);
    }
}

TEST(DynamicLights, AreTheSameEveryTime) {
    std::vector<LightSample> runs[2];
    for (auto& run : runs) {
        World world;
        std::mt19937 random(8);
        DynamicLights lights;
        lights.reset(world.emitters, 50, {}, *world.rays);
        for (int move = 0; move < 30; ++move) {
            world.place(random, 0.2f);
            lights.update(world.emitters, *world.rays);
        }
        run = lights.samples();
    }
    ASSERT_EQ(runs[0].size(), runs[1].size());
    for (std::size_t i = 0; i < runs[0].size(); ++i) {
        EXPECT_EQ(runs[0][i].position, runs[1][i].position);
        EXPECT_EQ(runs[0][i].flux, runs[1][i].flux);
    }
}

} // namespace
} // namespace sunfleck::gi

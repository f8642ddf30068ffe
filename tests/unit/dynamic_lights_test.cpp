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

// A ball at the origin that moves, of radius 1 and radiance 1.
Emitter ball_of_light() {
    Emitter ball;
    ball.kind = EmitterKind::sphere;
    ball.radiance = vec3(1.0f);
    ball.radius = 1.0f;
    ball.area = 4.0f * pi;
    ball.flux = vec3(pi * ball.area);
    ball.moves = ball.ball = true;
    return ball;
}

std::vector<LightSample> samples_of(const Emitter& emitter, std::uint32_t count) {
    const auto rays = raytrace::RayScene::create().value();
    std::vector<LightSample> samples;
    for (std::uint32_t i = 0; i < count; ++i)
        samples.push_back(make_direct_sample(emitter, i, count, {}, *rays));
    return samples;
}

// pi R^2 / d^2 times the cosine, wherever the whole ball is above the horizon: from one radius above the surface, where
// a sample is no further away than its neighbours, to a hundred.
TEST(DynamicLights, ABallLightsAsInTheClosedForm) {
    for (const std::uint32_t count : {1u, 6u, 64u, 1024u}) {
        const std::vector<LightSample> samples = samples_of(ball_of_light(), count);
        std::mt19937 random(3);
        std::normal_distribution<float> coordinate;
        double worst = 0.0;
        for (const float distance : {2.0f, 5.0f, 100.0f})
            for (int place = 0; place < 20; ++place) {
                const vec3 normal = -glm::normalize(vec3(coordinate(random), coordinate(random), coordinate(random)));
                const vec3 at = -distance * normal;
                double found = 0.0;
                for (const LightSample& sample : samples) {
                    ASSERT_EQ(sample.kind, SampleKind::point);
                    const vec3 to_light = sample.position - at;
                    const float squared = glm::dot(to_light, to_light);
                    found += double(sample.flux.x / (4.0f * pi) * glm::dot(normal, to_light) /
                                    (squared * std::sqrt(squared)));
                }
                worst = std::max(worst, std::abs(found * double(distance * distance / pi) - 1.0));
            }
        // One sample is exact. N points, well spread in three dimensions, err by about N^(-2/3) of a smooth function.
        EXPECT_LT(worst, count == 1 ? 1e-5 : std::pow(double(count), -2.0 / 3.0)) << count;
    }
}

// From far away, a ball is a disc of even brightness: its share beyond a straight edge is that of the disc. Points on a
// shell, or evenly in the ball, would be off by 0.06 or 0.04.
TEST(DynamicLights, ABallCastsThePenumbraOfADisc) {
    constexpr std::uint32_t count = 16384;
    const std::vector<LightSample> samples = samples_of(ball_of_light(), count);
    const double shrunk = 1.0 - 1.0 / std::sqrt(double(count)); // few samples stay near the centre
    for (const vec3 direction : {vec3(1, 0, 0), vec3(0, 1, 0), vec3(0, 0, 1), glm::normalize(vec3(1, -2, 3))})
        for (const double edge : {-0.9, -0.5, 0.0, 0.3, 0.7}) {
            double beyond = 0.0;
            for (const LightSample& sample : samples)
                beyond += double(glm::dot(sample.position, direction)) > shrunk * edge ? 1.0 / count : 0.0;
            EXPECT_NEAR(beyond, (std::acos(edge) - edge * std::sqrt(1.0 - edge * edge)) / double(pi), 0.01) << edge;
        }
}

} // namespace
} // namespace sunfleck::gi

#include "tests/support/sampled_scene.h"
#include "tests/support/test_size.h"

#include "gi_module/light_sampling/clamping_loss.h"

#include "engine/core/jobs.h"
#include "engine/core/random.h"

#include <random>

namespace sunfleck::gi {
namespace {

TEST(LightSampling, DirectFluxIsTheEmittersFlux) {
    for (auto make : {assets::make_cornell, assets::make_area_room, assets::make_four_pillars}) {
        const SampledScene world(make);
        double expected = 0;
        for (const Emitter& emitter : world.emitters)
            expected += double(luminance(emitter.flux));
        for (const std::uint32_t count : {1u, 7u, 300u, 2049u}) {
            const auto samples = sample_direct(world.emitters, count, {}, *world.rays);
            EXPECT_EQ(samples.size(), count);
            EXPECT_NEAR(total_luminance(samples) / expected, 1.0, 1e-5);
        }
    }
}

TEST(LightSampling, EmitterFluxHasItsClosedForm) {
    SampledScene world;
    assets::SceneBuilder builder(world.registry, world.meshes);
    builder.area_light("rectangle", {scene::AreaShape::rectangle, 2.0f, 3.0f, 0.0f, vec3(1.0f)}, {});
    builder.area_light("disc", {scene::AreaShape::disc, 0.0f, 0.0f, 0.5f, vec3(2.0f)}, {});
    builder.area_light("sphere", {scene::AreaShape::sphere, 0.0f, 0.0f, 0.25f, vec3(3.0f)}, {});
    const ecs::Entity point = world.registry.create(), spot = world.registry.create();
    world.registry.emplace<scene::Transform>(point);
    world.registry.emplace<scene::PointLight>(point, {vec3(5.0f)});
    world.registry.emplace<scene::Transform>(spot);
    world.registry.emplace<scene::SpotLight>(spot, {vec3(7.0f), 0.3f, 0.7f});
    world.finish();
    ASSERT_EQ(world.emitters.size(), 5u);
    EXPECT_NEAR(world.emitters[0].flux.x, pi * 6.0f, 1e-4f);
    EXPECT_NEAR(world.emitters[1].flux.x, pi * pi * 0.25f * 2.0f, 1e-4f);
    EXPECT_NEAR(world.emitters[2].flux.x, pi * 4.0f * pi * 0.0625f * 3.0f, 1e-3f);
    EXPECT_NEAR(world.emitters[3].flux.x, 4.0f * pi * 5.0f, 1e-3f);
    // The spot's flux by numerical integration of its falloff.
    float scale, offset;
    spot_cone(world.emitters[4], scale, offset);
    double integral = 0;
    const int steps = 100000;
    for (int i = 0; i < steps; ++i) {
        const double cosine = 1.0 - (double(i) + 0.5) / steps;
        const double falloff = std::clamp(cosine * double(scale) + double(offset), 0.0, 1.0);
        integral += falloff * falloff / steps;
    }
    EXPECT_NEAR(double(world.emitters[4].flux.x), 7.0 * 2.0 * 3.14159265358979 * integral, 1e-3);
}

TEST(LightSampling, BadLightsAreLeftOut) {
    SampledScene world;
    const auto add = [&](vec3 intensity) {
        const ecs::Entity entity = world.registry.create();
        world.registry.emplace<scene::Transform>(entity);
        world.registry.emplace<scene::PointLight>(entity, {intensity});
    };
    add(vec3(NAN));
    add(vec3(-1.0f));
    add(vec3(INFINITY));
    add(vec3(0.0f));
    assets::SceneBuilder builder(world.registry, world.meshes);
    builder.area_light("flat", {scene::AreaShape::rectangle, 0.0f, 3.0f, 0.0f, vec3(1.0f)}, {});
    world.finish();
    EXPECT_TRUE(world.emitters.empty());
    EXPECT_TRUE(sample_direct(world.emitters, 10, {}, *world.rays).empty());
    EXPECT_TRUE(sample_indirect(world.emitters, 10, {}, *world.rays).empty());
}

TEST(LightSampling, SaysHowFarItIsAndCanBeStopped) {
    const SampledScene world(assets::make_four_pillars);
    SampleRequest settings;
    constexpr std::uint32_t count = 2000;
    for (const std::uint32_t candidates : {1u, 64u}) {
        settings.candidates = candidates;
        std::vector<float> shares;
        float until = 2.0f;
        const auto sampled = [&] {
            shares.clear();
            return sample_indirect(world.emitters, count, settings, *world.rays, [&](float share) {
                shares.push_back(share);
                return share < until;
            });
        };
        EXPECT_EQ(sampled().size(), count);
        EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
        const auto before = [&](float share) {
            return std::lower_bound(shares.begin(), shares.end(), share) - shares.begin();
        };
        EXPECT_GT(before(0.5f), 1) << "walks";
        EXPECT_GT(before(1.0f) - before(0.5f), 1) << (candidates > 1 ? "clusters" : "walks");
        EXPECT_EQ(before(1.01f), std::ptrdiff_t(shares.size()));
        for (until = 0.0f; until < (candidates > 1 ? 0.95f : 0.45f); until += 0.1f) {
            EXPECT_TRUE(sampled().empty()) << until;
            EXPECT_GE(shares.back(), until);
            EXPECT_EQ(before(until), std::ptrdiff_t(shares.size()) - 1) << "it goes on";
        }
    }
}

TEST(LightSampling, CountsAreExactAndResultsIndependentOfThreads) {
    const SampledScene world(assets::make_four_pillars);
    for (const Sequence sequence : {Sequence::sobol, Sequence::pseudo_random})
        for (const Termination termination : {Termination::bounce_limit, Termination::russian_roulette})
            for (const std::uint32_t count : {1u, 7u, 300u, tests::sanitized() ? 301u : 2049u}) {
                SampleRequest settings;
                settings.sequence = sequence;
                settings.termination = termination;
                std::vector<LightSample> one, two;
                {
                    const ThreadLimit limit(1);
                    one = sample_indirect(world.emitters, count, settings, *world.rays);
                }
                two = sample_indirect(world.emitters, count, settings, *world.rays);
                ASSERT_EQ(one.size(), count);
                ASSERT_EQ(two.size(), count);
                for (std::size_t i = 0; i < count; ++i) {
                    ASSERT_EQ(one[i].position, two[i].position);
                    ASSERT_EQ(one[i].flux, two[i].flux);
                    ASSERT_GE(one[i].bounce, 1u);
                    ASSERT_LE(one[i].bounce, settings.bounces);
                }
            }
}

TEST(RayScene, StaticGeometryIsBuiltOnceAndMoversFollow) {
    SampledScene world(assets::make_four_pillars);
    const std::uint32_t builds = world.rays->static_builds();
    const std::uint64_t generation = world.rays->static_generation();
    const ecs::Entity torus = scene::find_by_name(world.registry, "torus");
    const raytrace::Ray down{vec3(1.32f, 3.0f, 0.0f), vec3(0.0f, -1.0f, 0.0f), 0.0f, 100.0f};
    const auto hit_entity = [&] {
        const auto hit = world.rays->closest_hit(down);
        return hit ? world.rays->surface(down, *hit).entity : ecs::null_entity;
    };
    EXPECT_EQ(hit_entity(), torus);
    world.registry.patch<scene::Transform>(torus, [](scene::Transform& t) { t.position.x = -2.0f; });
    scene::update_world_transforms(world.registry);
    ASSERT_TRUE(world.rays->update(world.registry, world.meshes));
    EXPECT_NE(hit_entity(), torus);
    EXPECT_EQ(world.rays->static_builds(), builds);
    EXPECT_EQ(world.rays->static_generation(), generation);
    const ecs::Entity pillar = scene::find_by_name(world.registry, "pillar 0");
    world.registry.patch<scene::Material>(pillar, [](scene::Material& m) { m.base_colour.x = 0.1f; });
    ASSERT_TRUE(world.rays->update(world.registry, world.meshes));
    EXPECT_EQ(world.rays->static_builds(), builds) << "a colour moves no geometry";
    EXPECT_GT(world.rays->static_generation(), generation) << "but what was derived from it is old";
    world.registry.patch<scene::Transform>(pillar, [](scene::Transform& t) { t.position.x += 0.1f; });
    scene::update_world_transforms(world.registry);
    ASSERT_TRUE(world.rays->update(world.registry, world.meshes));
    EXPECT_EQ(world.rays->static_builds(), builds + 1);
}

// A mover whose transform has no inverse is met where it lies: as a plate, which also moves, or not at all.
TEST(RayScene, MoversMayBeFlatOrNothing) {
    SampledScene world(assets::make_four_pillars);
    const ecs::Entity torus = scene::find_by_name(world.registry, "torus");
    const scene::Transform whole = *world.registry.try_get<scene::Transform>(torus);
    RandomSequence random(SequenceKind::pseudo_random, 3, 1);
    const auto height_met = [&](vec3 scale, float height) -> float {
        scene::Transform placed = whole;
        placed.rotation = glm::quat(1.0f, 0.0f, 0.0f, 0.0f);
        placed.scale = scale;
        placed.position.y = height;
        world.registry.emplace_or_replace<scene::Transform>(torus, placed);
        scene::update_world_transforms(world.registry);
        EXPECT_TRUE(world.rays->update(world.registry, world.meshes));
        float met = -1.0f;
        for (int i = 0; i < 2000; ++i) {
            const float x = whole.position.x + random.next() - 0.5f, z = whole.position.z + random.next() - 0.5f;
            const raytrace::Ray down{vec3(x, 3.0f, z), vec3(0.0f, -1.0f, 0.0f), 0.0f, 100.0f};
            const auto hit = world.rays->closest_hit(down);
            if (hit && world.rays->surface(down, *hit).entity == torus)
                met = 3.0f - hit->distance;
        }
        return met;
    };
    EXPECT_GT(height_met(whole.scale, 1.5f), 1.4f);
    EXPECT_NEAR(height_met(whole.scale * vec3(1.0f, 0.0f, 1.0f), 1.5f), 1.5f, 1e-5f);
    EXPECT_NEAR(height_met(whole.scale * vec3(1.0f, 1e-12f, 1.0f), 1.25f), 1.25f, 1e-5f);
    EXPECT_EQ(height_met(vec3(0.0f), 1.5f), -1.0f);
    EXPECT_EQ(height_met(vec3(1e-25f), 1.5f), -1.0f);
    EXPECT_GT(height_met(whole.scale, 1.5f), 1.4f) << "and back";
}

TEST(RayScene, PacketsGiveTheAnswersOfSingleRays) {
    const SampledScene world(assets::make_table_room);
    RandomSequence random(SequenceKind::pseudo_random, 3, 1);
    const auto point = [&] {
        return world.bounds.minimum + world.bounds.extent() * vec3(random.next(), random.next(), random.next());
    };
    int occluded = 0;
    for (int i = 0; i < 2000; ++i) {
        raytrace::ShadowPacket packet;
        packet.active = std::uint32_t(random.next() * 65536.0f);
        for (raytrace::Ray& ray : packet.rays) {
            const vec3 from = point();
            ray = {from, point() - from, 0.0f, 1.0f};
        }
        const std::uint32_t result = world.rays->occluded(packet);
        for (std::uint32_t k = 0; k < raytrace::packet_size; ++k) {
            const bool expected = ((packet.active >> k) & 1u) && world.rays->occluded(packet.rays[k]);
            ASSERT_EQ(bool((result >> k) & 1u), expected);
            occluded += expected;
        }
    }
    EXPECT_GT(occluded, 1000);
}

// A point light in the open, over a small square: one walk in 1,000 hits it, and others are not tried for ever. Flux is
// the light's share in the square's solid angle, as often as it is reflected.
TEST(LightSampling, WalksInTheOpenAreBoundedAndKeepTheirFlux) {
    SampledScene world;
    const float height = 2.0f, half = 0.1123f;
    assets::SceneBuilder builder(world.registry, world.meshes);
    builder.quad("square", vec3(-half, 0, half), vec3(2 * half, 0, 0), vec3(0, 0, -2 * half),
                 assets::diffuse(vec3(0.5f)));
    const ecs::Entity light = world.registry.create();
    world.registry.emplace<scene::Transform>(light, {vec3(0, height, 0)});
    world.registry.emplace<scene::PointLight>(light, {vec3(1.0f)});
    world.finish();
    const double share = std::asin(double(half * half / (half * half + height * height))) / 3.14159265358979;
    ASSERT_NEAR(share, 1e-3, 1e-5);
    const int seeds = 16;
    double flux = 0;
    for (int seed = 1; seed <= seeds; ++seed) {
        SampleRequest settings;
        settings.candidates = 1;
        settings.seed = std::uint32_t(seed);
        settings.termination = Termination::bounce_limit; // every hit is a sample
        const auto samples = sample_indirect(world.emitters, 1000, settings, *world.rays);
        // 65,536 walks, of which 66 hit; the limits are four standard deviations of independent walks.
        EXPECT_GT(samples.size(), 33u);
        EXPECT_LT(samples.size(), 99u);
        flux += total_luminance(samples) / seeds;
    }
    EXPECT_NEAR(flux / (4.0 * 3.14159265358979 * 0.5 * share), 1.0, 4.0 / std::sqrt(65.5 * seeds));
}

// A sample on the floor under a parallel ceiling at height h: over its lobe the squared cosine u is uniform in [0, 1],
// the term is u^2 / h^2, so a bound b takes away the integral of 1 - b h^2 / u^2 from sqrt(b) h to 1, (1 - sqrt(b)
// h)^2.
TEST(LightSampling, TheBoundsLossHasItsClosedForm) {
    SampledScene world;
    assets::SceneBuilder builder(world.registry, world.meshes);
    const float far = 1e4f, height = 2.0f;
    builder.quad("ceiling", vec3(-far, height, -far), vec3(2 * far, 0, 0), vec3(0, 0, 2 * far),
                 assets::diffuse(vec3(1)));
    world.finish();
    std::vector<LightSample> samples(64);
    for (std::uint32_t i = 0; i < samples.size(); ++i) {
        samples[i].flux = vec3(float(i + 1));
        samples[i].index = i;
    }
    samples[7].dynamic = true;
    samples[8].kind = SampleKind::point;
    for (const float share : {0.1f, 0.5f, 0.9f, 1.5f}) {
        const float bound = share * share / (height * height);
        const std::vector<float> bounds(samples.size(), bound);
        const double expected = share < 1.0f ? std::pow(1.0 - double(share), 2.0) : 0.0;
        EXPECT_NEAR(clamping_loss(samples, bounds, *world.rays), expected, 1e-3) << share;
    }
    EXPECT_EQ(clamping_loss({}, {}, *world.rays), 0.0);
}

} // namespace
} // namespace sunfleck::gi

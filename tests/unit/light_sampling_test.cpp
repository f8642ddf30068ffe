#include "tests/support/sampled_scene.h"
#include "tests/support/test_size.h"

#include "gi_module/light_sampling/clamping_loss.h"
#include "gi_module/light_sampling/sample_clusters.h"

#include "engine/core/jobs.h"
#include "engine/core/random.h"

#include <random>

namespace sunfleck::gi {
namespace {

double total_luminance(const std::vector<LightSample>& samples) {
    double sum = 0;
    for (const LightSample& sample : samples)
        sum += double(luminance(sample.flux));
    return sum;
}

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

// Clusters keep the flux of all candidates, and every sample is one that a walk has left.
TEST(LightSampling, ClustersKeepTheFlux) {
    const SampledScene world(assets::make_gap_room);
    SampleRequest plain;
    plain.candidates = 1;
    const auto many = sample_indirect(world.emitters, 20000, plain, *world.rays);
    for (const float spread : {0.0f, 0.5f, 1.0f})
        for (const std::uint32_t count : {1u, 7u, 225u}) {
            const auto few = cluster_samples(many, count, spread, 1);
            ASSERT_EQ(few.size(), count);
            EXPECT_NEAR(total_luminance(few) / total_luminance(many), 1.0, 1e-4);
            glm::dvec3 all(0.0), kept(0.0);
            for (const LightSample& sample : many)
                all += glm::dvec3(sample.flux);
            for (const LightSample& sample : few)
                kept += glm::dvec3(sample.flux);
            for (int channel = 0; channel < 3; ++channel)
                EXPECT_NEAR(kept[channel] / all[channel], 1.0, 1e-4);
            for (const LightSample& sample : few) {
                EXPECT_TRUE(std::any_of(many.begin(), many.end(),
                                        [&](const LightSample& s) { return s.position == sample.position; }));
            }
        }
}

// A disc of samples, evenly spread, is one cluster: its stand-in is at the centre, with the disc's radius. Two discs
// far apart are two clusters.
TEST(LightSampling, AClusterIsItsMiddleAndHasItsRadius) {
    std::mt19937 random(11);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    const auto disc = [&](vec3 centre, float radius, std::vector<LightSample>& samples) {
        for (int i = 0; i < 4000; ++i) {
            const float distance = radius * std::sqrt(unit(random)), angle = 2.0f * pi * unit(random);
            LightSample sample;
            sample.position = centre + distance * vec3(std::cos(angle), 0.0f, std::sin(angle));
            sample.flux = vec3(1.0f, 2.0f, 0.5f);
            samples.push_back(sample);
        }
    };
    std::vector<LightSample> samples;
    disc(vec3(0.0f), 0.7f, samples);
    const auto one = cluster_samples(samples, 1, 0.5f, 1);
    ASSERT_EQ(one.size(), 1u);
    EXPECT_LT(glm::length(one[0].position), 0.05f);
    EXPECT_NEAR(one[0].radius, 0.7f, 0.02f);
    disc(vec3(10.0f, 0.0f, 0.0f), 0.2f, samples);
    const auto two = cluster_samples(samples, 2, 0.5f, 1);
    ASSERT_EQ(two.size(), 2u);
    EXPECT_NEAR(std::max(two[0].radius, two[1].radius), 0.7f, 0.02f);
    EXPECT_NEAR(std::min(two[0].radius, two[1].radius), 0.2f, 0.01f);
}

// At points farther than a metre from every wall's samples, without shadows, 225 clusters say what 20,000 samples say
// several times as well as 225 walks do: relative errors over four seeds, squared.
TEST(LightSampling, ClustersSayWhatAllSay) {
    const SampledScene world(assets::make_cornell);
    std::mt19937 random(12);
    std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
    const auto irradiance = [](const std::vector<LightSample>& samples, vec3 point, vec3 normal) {
        double sum = 0.0;
        for (const LightSample& sample : samples) {
            const vec3 away = point - sample.position;
            const float square = glm::dot(away, away);
            const float cosines =
                std::max(glm::dot(sample.normal, away), 0.0f) * std::max(-glm::dot(normal, away), 0.0f);
            sum += double(luminance(sample.flux)) * double(cosines) / double(square) / double(std::max(square, 0.25f));
        }
        return sum;
    };
    double clusters = 0.0, walks = 0.0;
    for (std::uint32_t seed = 1; seed <= 4; ++seed) {
        SampleRequest settings;
        settings.candidates = 1;
        settings.seed = seed;
        const auto many = sample_indirect(world.emitters, 20000, settings, *world.rays);
        const auto plain = sample_indirect(world.emitters, 225, settings, *world.rays);
        const auto few = cluster_samples(many, 225, 0.5f, 1);
        Bounds bounds;
        for (const LightSample& sample : many)
            bounds.add(sample.position);
        for (int i = 0; i < 200; ++i) {
            const vec3 point =
                bounds.centre() + 0.25f * bounds.extent() * vec3(unit(random), unit(random), unit(random));
            const vec3 normal = glm::normalize(vec3(unit(random), unit(random), unit(random)) + 1e-3f);
            const double truth = irradiance(many, point, normal);
            clusters += std::pow(irradiance(few, point, normal) / truth - 1.0, 2.0);
            walks += std::pow(irradiance(plain, point, normal) / truth - 1.0, 2.0);
        }
    }
    std::printf("squared error of 225 clusters %.2e, of 225 walks %.2e\n", clusters / 800.0, walks / 800.0);
    EXPECT_LT(3.0 * clusters, walks);
}

// Thesis sec. 6.1, fig. 6-1: few walks pass the gap, so what plain walks say of the light behind it is mostly noise.
// With clusters of 32 or 64 times as many walks, its error over seeds falls by that order, and in the mean they say
// what 400,000 walks say: a constant would have no variance, but not that mean.
TEST(LightSampling, ClustersKnowTheDarkSideOfTheGap) {
    const SampledScene world(assets::make_gap_room);
    const auto flux_behind = [&](std::uint32_t count, std::uint32_t candidates, std::uint32_t seed) {
        SampleRequest settings;
        settings.candidates = candidates;
        settings.seed = seed;
        double flux = 0;
        for (const LightSample& sample : sample_indirect(world.emitters, count, settings, *world.rays))
            flux += sample.position.x > 0.15f ? double(luminance(sample.flux)) : 0.0;
        return flux;
    };
    double truth = 0.0;
    for (std::uint32_t seed = 77; seed < 85; ++seed)
        truth += flux_behind(400000, 1, seed) / 8.0;
    ASSERT_GT(truth, 0.0);
    constexpr std::uint32_t seeds = 24;
    const auto errors = [&](std::uint32_t candidates) {
        double mean = 0, squares = 0;
        for (std::uint32_t seed = 1; seed <= seeds; ++seed) {
            const double error = flux_behind(225, candidates, seed) / truth - 1.0;
            mean += error / seeds;
            squares += error * error / seeds;
        }
        std::printf("%u candidates: %+.2f %% in the mean, relative MSE %.2e\n", candidates, 100.0 * mean, squares);
        return std::pair(mean, squares);
    };
    const double plain = errors(1).second;
    for (const std::uint32_t candidates : {32u, 64u}) {
        const auto [mean, squares] = errors(candidates);
        EXPECT_LT(4.0 * squares, plain);
        EXPECT_LT(std::abs(mean), 3.0 * std::sqrt(squares / seeds) + 0.03);
    }
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

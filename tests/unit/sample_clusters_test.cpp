#include "tests/support/sampled_scene.h"

#include "gi_module/light_sampling/sample_clusters.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace sunfleck::gi {
namespace {

// Clusters keep the flux of all candidates, and every sample is one that a walk has left.
TEST(SampleClusters, KeepTheFlux) {
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
TEST(SampleClusters, AClusterIsItsMiddleAndHasItsRadius) {
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
TEST(SampleClusters, SayWhatAllSay) {
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
TEST(SampleClusters, KnowTheDarkSideOfTheGap) {
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

// Evenly on a square of the plane through `corner`.
void add_square(std::vector<LightSample>& samples, vec3 corner, vec3 u, vec3 v, int count, float flux) {
    std::mt19937 random{std::uint32_t(samples.size())};
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    for (int i = 0; i < count; ++i) {
        LightSample sample;
        sample.position = corner + unit(random) * u + unit(random) * v;
        sample.normal = glm::normalize(glm::cross(u, v));
        sample.flux = vec3(flux / float(count));
        samples.push_back(sample);
    }
}

// Floor and wall meet in a corner, away from the origin and turned, so that planes hold only as well as floats do.
std::vector<LightSample> corner_samples(float flux_of_floor, float flux_of_wall) {
    const vec3 corner(3.7f, -1.3f, 2.9f), along = glm::normalize(vec3(0.6f, 0.2f, 0.7f));
    const vec3 inward = glm::normalize(glm::cross(along, vec3(0.1f, 1.0f, 0.3f))), up = glm::cross(inward, along);
    std::vector<LightSample> samples;
    add_square(samples, corner, along, inward, 600, flux_of_floor);
    add_square(samples, corner, up, along, 400, flux_of_wall);
    return samples;
}

// Two clusters of a corner are its two surfaces, each with its own flux and in its own middle.
TEST(SampleClusters, ACornerIsDividedByItsSurfaces) {
    const std::vector<LightSample> samples = corner_samples(3.0f, 2.0f);
    std::vector<LightSample> two = cluster_samples(samples, 2, 0.5f, 1);
    ASSERT_EQ(two.size(), 2u);
    if (two[0].flux.x < two[1].flux.x)
        std::swap(two[0], two[1]);
    const LightSample* of_surface[] = {&samples.front(), &samples.back()};
    for (int i = 0; i < 2; ++i) {
        EXPECT_NEAR(two[i].flux.x, i == 0 ? 3.0f : 2.0f, 1e-4f);
        EXPECT_EQ(two[i].normal, of_surface[i]->normal);
        // A disc with the variance of a square of 1 m: 2 * (1/12 + 1/12) is its radius squared.
        EXPECT_NEAR(two[i].radius, std::sqrt(1.0f / 3.0f), 0.02f);
    }
}

// One cluster of a corner stands on either surface, as often as that has flux, and in that surface's middle; its disc
// is that of both.
TEST(SampleClusters, AMixedClusterStandsOnOneOfItsSurfaces) {
    const std::vector<LightSample> samples = corner_samples(3.0f, 1.0f);
    constexpr std::uint32_t seeds = 400;
    std::uint32_t on_floor = 0;
    for (std::uint32_t seed = 1; seed <= seeds; ++seed) {
        const LightSample one = cluster_samples(samples, 1, 0.5f, seed).front();
        on_floor += one.normal == samples.front().normal;
        EXPECT_NEAR(one.flux.x, 4.0f, 1e-4f);
        vec3 middle(0.0f);
        double members = 0.0;
        for (const LightSample& sample : samples)
            if (sample.normal == one.normal)
                middle += sample.position, ++members;
        EXPECT_LT(glm::length(one.position - middle / float(members)), 0.05f);
        EXPECT_GT(one.radius, std::sqrt(1.0f / 3.0f) + 0.05f);
    }
    // Four standard deviations of as many draws with a share of three quarters.
    EXPECT_NEAR(double(on_floor) / seeds, 0.75, 4.0 * std::sqrt(0.75 * 0.25 / seeds));
}

// The cap of a ball, up to 12 degrees from its pole, is one surface, though no two of its normals are equal: its sample
// stands at the pole, and not at a place that depends on which member was drawn.
TEST(SampleClusters, ACurvedSurfaceIsOneSurface) {
    std::mt19937 random(13);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    std::vector<LightSample> samples;
    for (int i = 0; i < 4000; ++i) {
        const float height = 1.0f - unit(random) * (1.0f - std::cos(0.2f)), angle = 2.0f * pi * unit(random);
        const float side = std::sqrt(1.0f - height * height);
        LightSample sample;
        sample.normal = vec3(side * std::cos(angle), height, side * std::sin(angle));
        sample.position = 2.0f * sample.normal;
        sample.flux = vec3(1.0f);
        samples.push_back(sample);
    }
    for (std::uint32_t seed = 1; seed <= 20; ++seed)
        EXPECT_GT(cluster_samples(samples, 1, 0.5f, seed).front().normal.y, std::cos(0.01f));
}

// Of triangles without area, or too large for their normal: such a sample is a surface of its own, and nothing hangs.
TEST(SampleClusters, SamplesWithoutANormalAreKept) {
    const float nothing = std::numeric_limits<float>::quiet_NaN();
    for (const vec3 normal : {vec3(0.0f), vec3(nothing), vec3(0.0f, 0.5f, 0.0f)}) {
        std::vector<LightSample> samples = corner_samples(3.0f, 2.0f);
        for (std::size_t i = 0; i < samples.size(); i += 3)
            samples[i].normal = normal;
        for (const std::uint32_t count : {1u, 2u, 50u, 999u}) {
            const std::vector<LightSample> few = cluster_samples(samples, count, 0.5f, 1);
            EXPECT_LE(few.size(), count);
            EXPECT_NEAR(total_luminance(few) / total_luminance(samples), 1.0, 1e-4);
        }
    }
}

} // namespace
} // namespace sunfleck::gi

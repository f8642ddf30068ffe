// The scattering functions of the reference against quadratures of them, and the energy that they keep.
#include "assets/scene_builder.h"
#include "engine/core/random.h"
#include "gi_module/reference/bsdf.h"
#include "gi_module/reference/path.h"

#include <gtest/gtest.h>

#include <array>

namespace sunfleck::gi::reference {
namespace {

vec3 at_angle(double cosine, double azimuth = 0.0) {
    const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
    return {float(sine * std::cos(azimuth)), float(sine * std::sin(azimuth)), float(cosine)};
}

scene::Material material_of(float metallic, float roughness, float index = 1.5f, vec3 colour = vec3(1.0f)) {
    scene::Material material;
    material.base_colour = colour;
    material.metallic = metallic;
    material.roughness = roughness;
    material.index_of_refraction = index;
    material.specular = true;
    return material;
}

// Share of light from `outgoing` that is reflected, by midpoints of a grid of equal solid angles.
double reflected_share(const Bsdf& bsdf, double cosine) {
    constexpr int rings = 200, sectors = 96;
    double sum = 0.0;
    for (int i = 0; i < rings; ++i)
        for (int k = 0; k < sectors; ++k) {
            const double m = (i + 0.5) / rings, azimuth = 3.14159265358979 * (2.0 * (k + 0.5) / sectors);
            sum += double(bsdf.evaluate(at_angle(cosine), at_angle(m, azimuth)).x) * m;
        }
    return sum * 2.0 * 3.14159265358979 / (double(rings) * sectors);
}

double sampled_share(const Bsdf& bsdf, double cosine, std::uint32_t count) {
    double sum = 0.0;
    for (std::uint32_t i = 0; i < count; ++i) {
        const RandomSequence random(SequenceKind::sobol, 1, i);
        const float numbers[3] = {random.at(0), random.at(1), random.at(2)};
        BsdfSample result;
        if (bsdf.sample(at_angle(cosine), numbers, result) && result.direction.z > 0.0f)
            sum += double(result.weight.x);
    }
    return sum / count;
}

// Against doubles, which hold the squares of all floats.
TEST(MultipleImportanceSampling, WeightsOfAllDensitiesAddUpToOne) {
    const float densities[] = {0.0f, 1e-38f, 1e-25f, 1e-10f, 0.3f, 7.0f, 1e10f, 3e18f, 1e25f, 1e38f};
    for (const float a : densities)
        for (const float b : densities) {
            const float weight = power_heuristic(a, b);
            const double sum = double(a) * double(a) + double(b) * double(b);
            EXPECT_NEAR(weight, sum > 0.0 ? double(a) * double(a) / sum : 0.0, 1e-6) << a << " " << b;
            if (sum > 0.0) {
                EXPECT_NEAR(weight + power_heuristic(b, a), 1.0f, 1e-6f) << a << " " << b;
            }
        }
}

// A white surface in a white surrounding is as bright as that, whatever it is made of. Half a per cent is what linear
// interpolation in the tables may cost.
TEST(Bsdf, WhiteSurfacesReflectAllLight) {
    for (const float metallic : {0.0f, 0.4f, 1.0f})
        for (const float index : {1.0f, 1.5f, 2.5f})
            for (const float roughness : {0.0f, 0.1f, 0.25f, 0.4f, 0.55f, 0.7f, 0.85f, 1.0f})
                for (const double cosine : {0.05, 0.15, 0.3, 0.5, 0.8, 1.0}) {
                    const Bsdf bsdf(material_of(metallic, roughness, index));
                    // What smooth facets lose goes to few directions, which few samples find.
                    EXPECT_NEAR(sampled_share(bsdf, cosine, roughness < 0.2f ? 1u << 16 : 1u << 12), 1.0, 0.005)
                        << "metallic " << metallic << ", index " << index << ", roughness " << roughness << ", cosine "
                        << cosine;
                    if (roughness > 0.5f) {
                        EXPECT_NEAR(reflected_share(bsdf, cosine), 1.0, 0.005) << metallic << roughness << cosine;
                    }
                }
}

// sample() draws what density() says: counts in 8 rings and 16 sectors, by the chi-squared statistic. 50,000 samples;
// the limit is that of one false alarm in a million for as many degrees of freedom as there are cells (Wilson and
// Hilferty's approximation).
TEST(Bsdf, SamplesFollowTheirDensity) {
    constexpr int rings = 8, sectors = 16, count = 50000;
    for (const float metallic : {0.0f, 0.5f, 1.0f})
        for (const float roughness : {0.3f, 0.6f, 1.0f})
            for (const double cosine : {0.2, 0.6, 0.95}) {
                const Bsdf bsdf(material_of(metallic, roughness, 1.5f, vec3(0.7f, 0.5f, 0.3f)));
                const auto cell = [&](vec3 d) {
                    const double azimuth = std::atan2(double(d.y), double(d.x)) / 6.28318530717959 + 0.5;
                    return std::min(int(d.z * rings), rings - 1) * sectors +
                           std::min(int(azimuth * sectors), sectors - 1);
                };
                std::array<double, rings * sectors + 1> counted{}, expected{};
                double inside = 0.0;
                constexpr int fine = 24; // midpoints across a cell
                for (int i = 0; i < rings * fine; ++i)
                    for (int k = 0; k < sectors * fine; ++k) {
                        const vec3 d = at_angle((i + 0.5) / (rings * fine),
                                                6.28318530717959 * ((k + 0.5) / (sectors * fine) - 0.5));
                        const double share = double(bsdf.density(at_angle(cosine), d)) * 6.28318530717959 /
                                             (double(rings) * sectors * fine * fine);
                        expected[std::size_t(cell(d))] += share * count;
                        inside += share;
                    }
                expected.back() = std::max(0.0, 1.0 - inside) * count; // below the surface
                for (int i = 0; i < count; ++i) {
                    const RandomSequence random(SequenceKind::pseudo_random, 7, std::uint32_t(i));
                    const float numbers[3] = {random.at(0), random.at(1), random.at(2)};
                    BsdfSample result;
                    const bool above = bsdf.sample(at_angle(cosine), numbers, result) && result.direction.z > 0.0f;
                    counted[above ? std::size_t(cell(result.direction)) : counted.size() - 1] += 1.0;
                }
                double statistic = 0.0, cells = 0.0, rest_counted = 0.0, rest_expected = 0.0;
                for (std::size_t i = 0; i < counted.size(); ++i) {
                    if (expected[i] < 10.0) { // too few for the approximation: together
                        rest_counted += counted[i], rest_expected += expected[i];
                        continue;
                    }
                    statistic += (counted[i] - expected[i]) * (counted[i] - expected[i]) / expected[i];
                    cells += 1.0;
                }
                if (rest_expected >= 10.0)
                    statistic += (rest_counted - rest_expected) * (rest_counted - rest_expected) / rest_expected;
                const double term = 2.0 / (9.0 * cells);
                EXPECT_LT(statistic, cells * std::pow(1.0 - term + 4.75 * std::sqrt(term), 3.0))
                    << "metallic " << metallic << ", roughness " << roughness << ", cosine " << cosine;
            }
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

TEST(Bsdf, IsReciprocal) {
    for (const float metallic : {0.0f, 0.3f, 1.0f})
        for (const float roughness : {0.1f, 0.5f, 1.0f})
            for (const float index : {1.0f, 1.5f, 2.5f}) {
                const Bsdf bsdf(material_of(metallic, roughness, index, vec3(0.8f, 0.4f, 0.1f)));
                for (const double a : {0.05, 0.4, 0.9})
                    for (const double b : {0.1, 0.5, 1.0})
                        for (const double azimuth : {0.3, 2.0, 3.1}) {
                            const vec3 there = bsdf.evaluate(at_angle(a), at_angle(b, azimuth));
                            const vec3 back = bsdf.evaluate(at_angle(b, azimuth), at_angle(a));
                            for (int c = 0; c < 3; ++c)
                                EXPECT_NEAR(there[c], back[c], 1e-4f * there[c]) << metallic << roughness << index;
                        }
            }
}

// What light walks reflect is what the scattering function does, in the mean over all directions.
TEST(Bsdf, MeanReflectanceIsTheMeanOfTheScatteringFunction) {
    for (const float metallic : {0.0f, 0.5f, 1.0f})
        for (const float roughness : {0.3f, 0.7f, 1.0f}) {
            const scene::Material material = material_of(metallic, roughness, 1.5f, vec3(0.6f));
            const Bsdf bsdf(material);
            constexpr int rings = 64;
            double mean = 0.0;
            for (int i = 0; i < rings; ++i) {
                const double cosine = (i + 0.5) / rings;
                mean += sampled_share(bsdf, cosine, 1u << 12) * 2.0 * cosine / rings;
            }
            EXPECT_NEAR(double(mean_reflectance(material).x), mean, 0.003) << metallic << roughness;
        }
    const scene::Material lambertian;
    EXPECT_EQ(mean_reflectance(lambertian), lambertian.base_colour);
}

// Inside of a closed glowing ball a ray arrives at the wall at the angle at which it left it, so that radiance by that
// angle solves L(m) = e + integral of f(m, m') L(m') m' dm': here on a grid. The path tracer must find L(1) at the
// centre. A ball of flat triangles has 1.5e-4 less area than a round one, and smooth normals.
TEST(Bsdf, AClosedBallHasTheRadianceOfItsIntegralEquation) {
    constexpr int steps = 48, sectors = 96;
    constexpr double emission = 1.0;
    scene::Material material = material_of(0.0f, 1.0f, 1.5f, vec3(0.8f));
    const Bsdf bsdf(material);
    std::vector<double> kernel(std::size_t(steps) * steps, 0.0), radiance(steps, emission);
    for (int i = 0; i < steps; ++i)
        for (int k = 0; k < steps; ++k) {
            const double m = (k + 0.5) / steps;
            for (int s = 0; s < sectors; ++s)
                kernel[std::size_t(i) * steps + std::size_t(k)] +=
                    double(bsdf.evaluate(at_angle((i + 0.5) / steps), at_angle(m, 6.28318530717959 * s / sectors)).x) *
                    m * 6.28318530717959 / (double(sectors) * steps);
        }
    for (int round = 0; round < 200; ++round) {
        std::vector<double> next(steps, emission);
        for (int i = 0; i < steps; ++i)
            for (int k = 0; k < steps; ++k)
                next[std::size_t(i)] += kernel[std::size_t(i) * steps + std::size_t(k)] * radiance[std::size_t(k)];
        radiance = std::move(next);
    }
    ecs::Registry registry;
    scene::MeshStore meshes;
    assets::SceneBuilder builder(registry, meshes);
    scene::Mesh ball = scene::make_sphere(1.0f, 128);
    for (std::size_t i = 0; i < ball.indices.size(); i += 3)
        std::swap(ball.indices[i + 1], ball.indices[i + 2]); // seen from within
    for (vec3& normal : ball.normals)
        normal = -normal;
    material.emission = vec3(float(emission));
    builder.add("ball", ball, material);
    scene::update_world_transforms(registry);
    const auto rays = raytrace::RayScene::create().value();
    ASSERT_TRUE(rays->update(registry, meshes));
    const PathTracer tracer(*rays, collect_emitters(registry, meshes, meshes.bounds(0)));
    scene::CameraView camera;
    camera.position = vec3(0.0f);
    camera.target = vec3(0.0f, 0.0f, -1.0f);
    ReferenceSettings settings;
    settings.width = settings.height = 16;
    settings.bounces = unlimited_bounces;
    Accumulation accumulation;
    ASSERT_TRUE(tracer.accumulate(accumulation, camera, settings, 256));
    double mean = 0.0;
    for (const double sum : accumulation.sums)
        mean += sum / double(accumulation.sums.size()) / accumulation.samples;
    const double at_the_centre = radiance.back() + (radiance.back() - radiance[steps - 2]) * 0.5;
    EXPECT_NEAR(mean / at_the_centre, 1.0, 0.005) << mean << ", " << at_the_centre;
    EXPECT_GT(at_the_centre, 4.9); // the base alone, without energy lost: 1 / (1 - 0.8)
}

} // namespace
} // namespace sunfleck::gi::reference

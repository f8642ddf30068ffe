// Pixel lights against closed forms and integrals: flux, bounds, importance warping, reflective shadow maps.
#include "gi_module/light_sampling/importance_warping.h"
#include "gi_module/light_sampling/reflective_shadow_map.h"
#include "gi_module/transport/pixel_light.h"

#include "engine/core/random.h"
#include "tests/support/sampled_scene.h"
#include "tests/support/test_size.h"

#include <cmath>
#include <random>

namespace sunfleck::gi {
namespace {

const float exponents[] = {1.0f, 1.3f, 2.0f, 3.0f, 7.0f, 30.0f, 250.0f, 2000.0f, 10000.0f};

// The integral of the intensity over the sphere, by the midpoint rule in angles about the lobe's axis, fine where the
// lobe is: in the angle's sine as a multiple of its width.
double flux_over_sphere(vec3 axis, vec3 normal, float exponent, float reach, float distance) {
    vec3 side, up;
    orthonormal_basis(axis, side, up);
    const double width =
        std::min(9.0 / std::sqrt(double(exponent) * std::min(1.0, double(distance / reach)) + 1.0), 1.0) *
        1.5707963267948966;
    const int rings = tests::by_size(200, 600), spokes = tests::by_size(180, 720);
    double sum = 0;
    for (int i = 0; i < rings; ++i) {
        const double angle = (i + 0.5) / rings * width;
        double ring = 0;
        for (int k = 0; k < spokes; ++k) {
            const double turn = 2.0 * 3.141592653589793 * (k + 0.5) / spokes;
            const vec3 direction =
                glm::normalize(float(std::cos(angle)) * axis + float(std::sin(angle) * std::cos(turn)) * side +
                               float(std::sin(angle) * std::sin(turn)) * up);
            ring += double(shared::pixel_light_intensity(axis, normal, exponent, reach, direction, distance));
        }
        sum += ring / spokes * 2.0 * 3.141592653589793 * std::sin(angle) * width / rings;
    }
    return sum;
}

// Whatever exponent, tilt of the lobe against the surface, and distance at which the lobe has widened.
TEST(SplatPixelLights, KeepTheirFlux) {
    for (const float exponent : exponents)
        for (const float tilt : {0.0f, 0.3f, 0.8f, 1.2f, 1.5f})
            for (const float distance : {1.0f, 0.7f, 0.2f, 0.01f}) {
                const vec3 normal(0.0f, 1.0f, 0.0f), axis(std::sin(tilt), std::cos(tilt), 0.0f);
                EXPECT_NEAR(flux_over_sphere(axis, normal, exponent, 1.0f, distance), 1.0, 1e-3)
                    << "exponent " << exponent << ", tilt " << tilt << ", distance " << distance;
            }
}

TEST(SplatPixelLights, WidenTowardsTheSourceAndShineNowhereBehindTheSurface) {
    float before = 0.0f;
    for (int i = 0; i <= 100; ++i) {
        const float exponent = shared::widened_exponent(500.0f, 0.02f * float(i), 1.0f);
        EXPECT_GE(exponent, std::max(before, 1.0f));
        EXPECT_LE(exponent, 500.0f);
        before = exponent;
    }
    EXPECT_EQ(before, 500.0f);
    EXPECT_EQ(shared::widened_exponent(1.0f, 0.01f, 1.0f), 1.0f);
    const vec3 normal(0.0f, 1.0f, 0.0f), axis = glm::normalize(vec3(1.0f, 0.1f, 0.0f));
    EXPECT_GT(shared::pixel_light_intensity(axis, normal, 5.0f, 1.0f, axis, 2.0f), 0.0f);
    EXPECT_EQ(shared::pixel_light_intensity(axis, normal, 5.0f, 1.0f, glm::normalize(vec3(1.0f, -0.1f, 0.0f)), 2.0f),
              0.0f);
}

// A diffuse one is the light sample that all other techniques know.
TEST(SplatPixelLights, ADiffuseOneHasTheIntensityOfALightSample) {
    PixelLight light;
    light.flux = vec3(3.0f, 2.0f, 1.0f);
    light.area = 0.5f;
    LightSample sample;
    sample.flux = light.flux;
    const shared::PixelLightRow row = make_pixel_light_row(light, 0, 1.0f, 0.0f);
    const shared::LightRow expected = make_light_row(sample, 0, 0.0f, {});
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(row.row.intensity_slot[c], expected.intensity_slot[c], 1e-6f);
    EXPECT_NEAR(row.row.position_bound.w, pi / 0.5f, 1e-3f);
}

// Points that get at least the threshold lie in the ellipsoid: on the surface of eq. 7, and where the lobe widens.
TEST(SplatPixelLights, BoundsHoldAllLightAboveTheThreshold) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
    for (const float exponent : exponents)
        for (const float area : {0.0f, 1e-4f, 0.02f}) {
            PixelLight light;
            light.axis = glm::normalize(vec3(0.3f, 0.8f, 0.2f));
            light.exponent = exponent;
            if (exponent == 1.0f)
                light.axis = light.normal;
            light.flux = vec3(2.0f, 1.0f, 0.5f);
            light.area = area;
            const float least = 0.7f;
            const shared::PixelLightRow row = make_pixel_light_row(light, 0, 1.0f, least);
            vec3 side, up;
            orthonormal_basis(light.axis, side, up);
            int inside_threshold = 0;
            const float far = 1.02f * std::sqrt(row.row.intensity_slot.x / least);
            for (int i = 0; i < tests::by_size(20000, 400000); ++i) {
                // Most of the points near the axis, where the light is.
                const float angle = 1.57f * std::pow(uniform(random), exponent > 10.0f ? 4.0f : 1.0f);
                const float distance = far * uniform(random);
                const vec3 direction = std::cos(angle) * light.axis + std::sin(angle) * side;
                const float soft = exponent > 1.0f ? 0.0f : row.extent.x;
                const float irradiance = exponent > 1.0f
                                             ? light.flux.x *
                                                   shared::pixel_light_intensity(light.axis, light.normal, exponent,
                                                                                 row.extent.x, direction, distance) /
                                                   (distance * distance)
                                             : light.flux.x / pi * distance *
                                                   std::sqrt(std::pow(distance * std::cos(angle), 2.0f) + soft * soft) /
                                                   std::pow(distance * distance + soft * soft, 2.0f);
                if (irradiance < least)
                    continue;
                ++inside_threshold;
                const float along = (distance * std::cos(angle) - row.extent.y) / row.extent.z;
                const float across = distance * std::sin(angle) / row.extent.w;
                ASSERT_LE(along * along + across * across, 1.0f + 1e-4f)
                    << "exponent " << exponent << ", area " << area << ", angle " << angle << ", distance " << distance;
            }
            EXPECT_GT(inside_threshold, 20) << exponent;
        }
}

// All that a beam reflects crosses any plane that is farther from it than the piece of surface is wide.
TEST(SplatPixelLights, BeamsKeepTheirFlux) {
    PixelLight light;
    light.normal = glm::normalize(vec3(0.1f, 1.0f, 0.2f));
    light.axis = glm::normalize(vec3(0.5f, 0.8f, -0.1f));
    light.flux = vec3(3.0f, 2.0f, 1.0f);
    light.area = 4e-4f;
    light.wide[0] = vec3(0.02f, 0.0f, 0.004f);
    light.wide[1] = vec3(0.003f, -0.001f, 0.015f);
    light.turned[0] = vec3(0.1f, -0.06f, 0.2f);
    light.turned[1] = vec3(-0.02f, 0.03f, 0.01f);
    for (const float exponent : {30.0f, 1000.0f, 1e5f}) {
        light.exponent = exponent;
        const shared::PixelLightRow row = make_pixel_light_row(light, 0, 1.0f, 0.1f);
        ASSERT_GT(row.beam0.w, 0.0f);
        for (const float along : {0.05f, 0.7f, 3.0f}) {
            // Over six standard deviations of the widest direction, in steps that the narrowest one allows.
            const vec4 covariance = row.beam0 + along * (row.beam1 + along * row.beam2);
            const float reach = 6.0f * std::sqrt(covariance.x + covariance.z);
            const vec3 x = shared::lobe_tangent(light.axis), y = glm::cross(light.axis, x);
            double sum = 0.0;
            const int steps = 800;
            for (int i = 0; i < steps * steps; ++i) {
                const vec2 place = (vec2(float(i % steps), float(i / steps)) + 0.5f) * (2.0f / float(steps)) - 1.0f;
                const vec3 way = along * light.axis + reach * (place.x * x + place.y * y);
                sum += double(shared::beam_density(light.axis, row.beam0, row.beam1, row.beam2, way));
            }
            const float wide = 4.0f * (row.beam0.x + row.beam0.z), outside = along * along / (along * along + wide);
            EXPECT_NEAR(sum * std::pow(2.0 * double(reach) / steps, 2.0), outside, 1e-3) << exponent << ", " << along;
            EXPECT_GT(outside, along > 0.5f ? 0.99f : 0.5f);
        }
        EXPECT_NEAR(row.row.intensity_slot.x * row.beam0.w, light.flux.x, 1e-4f * light.flux.x);
    }
    light.exponent = 5.0f; // too wide to be a Gaussian
    EXPECT_EQ(make_pixel_light_row(light, 0, 1.0f, 0.1f).beam0.w, 0.0f);
}

TEST(SplatPixelLights, DefectiveOnesAreDarkOrFinite) {
    for (const float flux : {0.0f, -1.0f, std::nanf(""), INFINITY})
        for (const float exponent : {0.0f, 1.0f, INFINITY, std::nanf("")}) {
            PixelLight light;
            light.flux = vec3(flux);
            light.exponent = exponent;
            light.area = 0.01f;
            const shared::PixelLightRow row = make_pixel_light_row(light, 0, 1.0f, 0.1f);
            EXPECT_EQ(row.row.intensity_slot.x, 0.0f);
            EXPECT_TRUE(std::isfinite(row.lobe.w) && row.lobe.w >= 1.0f);
            for (int i = 0; i < 4; ++i)
                EXPECT_TRUE(std::isfinite(row.extent[i]));
        }
}

std::vector<float> some_importances(std::uint32_t side, std::uint32_t seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
    std::vector<float> values(std::size_t(side) * side);
    for (float& value : values)
        value = std::pow(uniform(random), 4.0f) + 0.01f;
    return values;
}

// The density that a method has in the cell of a level, by its definition: method A that of the map; method B at each
// level a product of marginals.
double expected_density(const ImportanceMap& map, WarpMethod method, std::uint32_t level, std::uint32_t x,
                        std::uint32_t y) {
    if (method == WarpMethod::a)
        return double(map.sum(level, x, y)) / double(map.total());
    double density = 1.0;
    for (std::uint32_t l = 1; l <= level; ++l) {
        const std::uint32_t cx = x >> (level - l), cy = y >> (level - l);
        const auto at = [&](std::uint32_t dx, std::uint32_t dy) { return double(map.sum(l, cx ^ dx, cy ^ dy)); };
        const double all = at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1);
        density *= (at(0, 0) + at(0, 1)) / all * (at(0, 0) + at(1, 0)) / all;
    }
    return density;
}

// Critical value of the chi-squared distribution at p = 0.001 (E. Wilson and M. Hilferty, 1931).
double critical_value(double freedom) {
    const double z = 3.0902, k = 2.0 / (9.0 * freedom);
    return freedom * std::pow(1.0 - k + z * std::sqrt(k), 3.0);
}

// Points that are independent of each other, so that their counts are multinomial. Of 160 tests none may be beyond
// p = 0.001 more than once.
TEST(SplatWarping, HasTheDensityOfItsMap) {
    const std::uint32_t side = 16, points = 20000;
    int beyond = 0, tests = 0;
    for (std::uint32_t seed = 1; seed <= 20; ++seed) {
        const ImportanceMap map(some_importances(side, seed), side);
        for (const WarpMethod method : {WarpMethod::a, WarpMethod::b})
            for (std::uint32_t level = 1; level <= map.levels(); ++level, ++tests) {
                std::vector<double> counts(std::size_t(1) << (2 * level), 0.0);
                std::mt19937 random(seed * 31 + level);
                std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
                for (std::uint32_t i = 0; i < points; ++i) {
                    const float x = uniform(random), y = uniform(random);
                    const WarpedPoint point = map.warp(vec2(x, y), method, level);
                    const float cells = float(1u << level);
                    counts[(std::size_t(point.place.y * cells) << level) + std::size_t(point.place.x * cells)] += 1.0;
                }
                double chi = 0.0, freedom = -1.0;
                for (std::uint32_t y = 0; y < (1u << level); ++y)
                    for (std::uint32_t x = 0; x < (1u << level); ++x) {
                        const double expected = points * expected_density(map, method, level, x, y);
                        const double found = counts[(std::size_t(y) << level) + x];
                        chi += (found - expected) * (found - expected) / expected;
                        freedom += 1.0;
                    }
                beyond += chi > critical_value(freedom);
            }
    }
    EXPECT_EQ(tests, 160);
    EXPECT_LE(beyond, 1);
}

// Weights make up for the density: a sum over points is the sum over the map, whatever is summed.
TEST(SplatWarping, WeightsMakeEstimatesUnbiased) {
    const std::uint32_t side = 32, points = 256, sets = tests::by_size(200u, 2000u);
    const std::vector<float> values = some_importances(side, 5);
    std::vector<float> summed(values.size()); // not the importance itself
    for (std::size_t i = 0; i < summed.size(); ++i)
        summed[i] = 1.0f + float(i % 7) + 3.0f * values[i];
    double truth = 0.0;
    for (const float value : summed)
        truth += double(value);
    for (const WarpMethod method : {WarpMethod::a, WarpMethod::b})
        for (const std::uint32_t levels : {0u, 1u, 3u, 5u}) {
            const ImportanceMap map(values, side);
            double weights = 0.0, weights2 = 0.0, estimates = 0.0, squares = 0.0;
            for (std::uint32_t set = 0; set < sets; ++set) {
                double weight = 0.0, estimate = 0.0;
                for (std::uint32_t i = 0; i < points; ++i) {
                    const RandomSequence random(SequenceKind::sobol, set + 1, i);
                    const WarpedPoint point = map.warp(vec2(random.at(0), random.at(1)), method, levels);
                    const std::size_t at = std::size_t(point.place.y * side) * side + std::size_t(point.place.x * side);
                    weight += double(point.weight) / points;
                    estimate += double(point.weight * summed[at]) * side * side / points;
                }
                weights += weight, weights2 += weight * weight;
                estimates += estimate, squares += estimate * estimate;
            }
            const auto near = [&](double sum, double square, double expected) {
                const double mean = sum / sets, deviation = std::sqrt(std::max(square / sets - mean * mean, 0.0));
                EXPECT_NEAR(mean, expected, 4.0 * deviation / std::sqrt(double(sets)) + 1e-4 * expected) << levels;
            };
            near(weights, weights2, 1.0);
            near(estimates, squares, truth);
        }
}

TEST(SplatWarping, AnEmptyMapMovesNothing) {
    const ImportanceMap map(std::vector<float>(64, 0.0f), 8);
    const WarpedPoint point = map.warp(vec2(0.3f, 0.7f), WarpMethod::a, 3);
    EXPECT_NEAR(point.place.x, 0.3f, 1e-6f);
    EXPECT_NEAR(point.place.y, 0.7f, 1e-6f);
    EXPECT_NEAR(point.weight, 1.0f, 1e-6f);
}

// A point light in a closed box: all of its light arrives, and what its texels show is the box.
TEST(SplatReflectiveMap, OfAPointLightShowsAllThatItLights) {
    SampledScene scene;
    assets::SceneBuilder builder(scene.registry, scene.meshes);
    const vec3 albedo(0.6f, 0.5f, 0.4f);
    builder.room(vec3(-1, 0, -1), vec3(1, 2, 1), albedo, albedo, {albedo, albedo, albedo, albedo}, {});
    builder.point_light("bulb", vec3(0.2f, 1.2f, -0.1f), vec3(2.0f));
    scene.finish();
    const ReflectiveShadowMap map = trace_reflective_map(scene.emitters.front(), 64, {}, *scene.rays, scene.registry);
    vec3 flux(0.0f);
    float area = 0.0f;
    for (const ReflectiveTexel& texel : map.texels) {
        ASSERT_TRUE(texel.lit);
        flux += texel.diffuse;
        area += texel.area;
        EXPECT_FALSE(texel.on_mover);
    }
    const vec3 expected = 4.0f * pi * 2.0f * albedo;
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(flux[c], expected[c], 1e-3f * expected[c]);
    EXPECT_NEAR(area, 24.0f, 0.5f); // six sides of 4 m2
}

TEST(SplatReflectiveMap, KnowsMoversAndLeavesOutWhatIsNotAskedFor) {
    SampledScene scene;
    assets::SceneBuilder builder(scene.registry, scene.meshes);
    const vec3 albedo(0.5f);
    builder.room(vec3(-1, 0, -1), vec3(1, 2, 1), albedo, albedo, {albedo, albedo, albedo, albedo}, {});
    const ecs::Entity box = builder.box("box", vec3(-0.4f, 0, -0.4f), vec3(0.4f, 0.4f, 0.4f), assets::diffuse(albedo));
    builder.mover(box, {});
    builder.point_light("bulb", vec3(0.0f, 1.5f, 0.0f), vec3(1.0f));
    scene.finish();
    const auto flux = [&](const MapSurfaces& surfaces) {
        double sum = 0.0;
        for (const ReflectiveTexel& texel :
             trace_reflective_map(scene.emitters.front(), 32, surfaces, *scene.rays, scene.registry).texels)
            sum += double(texel.diffuse.x);
        return sum;
    };
    const double all = flux({}), fixed = flux({true, false}), movers = flux({false, true});
    EXPECT_GT(movers, 0.02 * all);
    EXPECT_GT(fixed, 0.5 * all);
    EXPECT_NEAR(fixed + movers, all, 1e-5 * all);
}

} // namespace
} // namespace sunfleck::gi

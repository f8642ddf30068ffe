// Light tracing against closed forms, and against the path tracer where both find all light.
#include "assets/test_rooms.h"
#include "engine/core/jobs.h"
#include "tests/support/test_size.h"
#include "tests/unit/scene_from_both_ends.h"

#include <cmath>
#include <map>
#include <numeric>

namespace sunfleck::gi::reference {
namespace {

using tests::aimed;
using tests::by_size;
using tests::clear_glass;
using tests::furnish;
using tests::lamps;
using Scene = tests::SceneFromBothEnds;

// Means and their standard errors over independent pictures: of blocks of 4x4 pixels, the whole picture last.
struct Blocks {
    std::vector<double> mean, error;
};
template <typename Tracer>
Blocks blocks_of(const Scene& scene, const Tracer& tracer, std::uint32_t samples) {
    constexpr std::uint32_t pictures = 8;
    const std::size_t across = scene.settings.width / 4, count = across * (scene.settings.height / 4) + 1;
    std::vector<double> sum(count), squares(count);
    ReferenceSettings settings = scene.settings;
    for (std::uint32_t seed = 1; seed <= pictures; ++seed) {
        settings.seed = seed;
        Accumulation picture;
        EXPECT_TRUE(tracer.accumulate(picture, scene.camera, settings, samples));
        std::vector<double> block(count);
        for (std::size_t i = 0; i < picture.counts.size(); ++i) {
            const double light = picture.sums[i * 3] + picture.sums[i * 3 + 1] + picture.sums[i * 3 + 2];
            block[i / settings.width / 4 * across + i % settings.width / 4] += light / 16.0 / samples;
            block.back() += light / double(picture.counts.size()) / samples;
        }
        for (std::size_t b = 0; b < count; ++b) {
            sum[b] += block[b] / pictures;
            squares[b] += block[b] * block[b] / pictures;
        }
    }
    Blocks result{sum, std::vector<double>(count)};
    for (std::size_t b = 0; b < count; ++b)
        result.error[b] = std::sqrt(std::max(squares[b] - sum[b] * sum[b], 0.0) / (pictures - 1));
    return result;
}

struct Bound {
    double error;            // of the whole picture, relative: says that the test sees something
    double deviations = 5.0; // standard errors
};

// Both differ by few standard errors. With seven degrees of freedom each, 5 are exceeded by one block in 5,000 by
// chance; some 300 are compared.
void expect_same_light(const Scene& scene, std::uint32_t samples, const std::string& what, Bound bound) {
    const Blocks camera = blocks_of(scene, *scene.from_camera, samples);
    const Blocks light = blocks_of(scene, *scene.from_light, samples);
    const double whole = camera.mean.back();
    double worst = 0.0;
    for (std::size_t b = 0; b < camera.mean.size(); ++b) {
        const double error = std::sqrt(camera.error[b] * camera.error[b] + light.error[b] * light.error[b]);
        const double off = std::abs(light.mean[b] - camera.mean[b]) / (error + 1e-6 * whole);
        EXPECT_LT(off, bound.deviations) << what << ", block " << b << ": " << light.mean[b] << " instead of "
                                         << camera.mean[b];
        worst = std::max(worst, off);
    }
    const double error = std::hypot(camera.error.back(), light.error.back()) / whole;
    EXPECT_LT(error, bound.error) << what;
    std::printf("%s: %+.2f %% (standard error %.2f %%), worst block %.1f standard errors\n", what.c_str(),
                100.0 * (light.mean.back() / whole - 1.0), 100.0 * error, worst);
}

TEST(LightTracer, EveryKindOfLampGivesTheIrradianceOfThePathTracer) {
    for (const tests::Lamp& lamp : lamps) {
        Scene scene;
        furnish(scene);
        lamp.add(scene.builder);
        scene.finish();
        scene.settings.bounces = 3;
        expect_same_light(scene, by_size(32u, 1024u), lamp.name, {by_size(0.012, 0.003)});
    }
}

TEST(LightTracer, RadianceIsThatOfThePathTracer) {
    for (const tests::Lamp& lamp : {lamps[0], lamps[3], lamps[5]}) {
        Scene scene;
        furnish(scene);
        lamp.add(scene.builder);
        scene.finish();
        scene.settings.bounces = unlimited_bounces;
        scene.settings.view = ReferenceView::radiance;
        expect_same_light(scene, by_size(32u, 1024u), std::string("radiance, ") + lamp.name, {by_size(0.012, 0.003)});
    }
}

TEST(LightTracer, DirectAndIndirectAddUp) {
    Scene scene;
    furnish(scene);
    lamps[0].add(scene.builder);
    scene.finish();
    double sums[3] = {};
    const ReferenceView views[] = {ReferenceView::direct, ReferenceView::indirect, ReferenceView::irradiance};
    for (int i = 0; i < 3; ++i) {
        scene.settings.view = views[i];
        for (const double sum : scene.picture(*scene.from_light, 8).sums)
            sums[i] += sum;
    }
    EXPECT_NEAR((sums[0] + sums[1]) / sums[2], 1.0, 1e-6);
    EXPECT_GT(sums[1], 0.1 * sums[2]);
}

TEST(LightTracer, SameBitsForOneAndTwoThreadsAndWhereverItIsStopped) {
    Scene scene;
    furnish(scene);
    lamps[3].add(scene.builder);
    scene.finish();
    scene.settings.width = 400; // two groups of particles a sample
    scene.settings.height = 200;
    scene.settings.view = ReferenceView::radiance;
    Accumulation one, split;
    {
        const ThreadLimit limit(1);
        one = scene.picture(*scene.from_light, 3);
    }
    EXPECT_EQ(one.sums, scene.picture(*scene.from_light, 3).sums);
    ASSERT_TRUE(scene.from_light->accumulate(split, scene.camera, scene.settings, 1));
    int stops = 0;
    while (!scene.from_light->accumulate(split, scene.camera, scene.settings, 2, [] { return true; }))
        ++stops;
    EXPECT_EQ(stops, 3);
    EXPECT_EQ(split.sums, one.sums);
    EXPECT_EQ(split.counts, one.counts);
    EXPECT_EQ(split.rays, one.rays);
    EXPECT_EQ(split.covered, one.covered);
    EXPECT_EQ(split.samples, 3u);
}

// E = I cos / d^2 below a point light, looked at from aside.
TEST(LightTracer, APointLightOverAPlaneHasItsClosedForm) {
    Scene scene;
    scene.builder.quad("floor", vec3(-5, 0, 5), vec3(10, 0, 0), vec3(0, 0, -10), assets::diffuse(vec3(0.5f)));
    scene.builder.point_light("lamp", vec3(0.2f, 1.5f, -0.3f), vec3(7.0f));
    scene.finish();
    scene.camera.position = vec3(1.0f, 2.0f, 1.5f);
    scene.camera.target = vec3(0.0f);
    const Accumulation picture = scene.picture(*scene.from_light, by_size(1024u, 16384u));
    const auto row = scene::make_camera_row(scene.camera, scene.settings.width, scene.settings.height);
    double squares = 0.0, sum = 0.0, expected_sum = 0.0;
    for (std::size_t i = 0; i < picture.counts.size(); ++i) {
        const vec2 centre = vec2(i % scene.settings.width, i / scene.settings.width) + 0.5f;
        const vec3 ray = shared::camera_ray(row, centre);
        const vec3 place = scene.camera.position - ray * (scene.camera.position.y / ray.y);
        const vec3 away = vec3(0.2f, 1.5f, -0.3f) - place;
        const double distance = double(glm::length(away)), expected = 7.0 * 1.5 / (distance * distance * distance);
        const double found = picture.sums[i * 3] / picture.samples;
        squares += std::pow(found / expected - 1.0, 2.0) / double(picture.counts.size());
        sum += found;
        expected_sum += expected;
    }
    // 390,000 particles, half of which miss: some 300 meet each pixel, fewer where it is dark.
    EXPECT_LT(std::sqrt(squares), by_size(0.08, 0.02));
    EXPECT_NEAR(sum / expected_sum, 1.0, by_size(0.003, 0.001));
}

double fresnel(double cosine, double index) {
    const double inside = std::sqrt(1.0 - (1.0 - cosine * cosine) / (index * index));
    const double s = (cosine - index * inside) / (cosine + index * inside);
    const double p = (index * cosine - inside) / (index * cosine + inside);
    return 0.5 * (s * s + p * p);
}

// A pane of glass lies between a point light and a plane. A ray at an angle a meets the plane at
// x(a) = (h - t) tan a + t tan b, sin a = 1.5 sin b, and what it carries is reduced by Fresnel's transmittance of both
// surfaces: E = I T sin a / (x dx/da). The path tracer finds nothing of it.
TEST(LightTracer, APointLightThroughAPaneHasItsClosedForm) {
    constexpr double height = 2.0, thickness = 0.5, intensity = 5.0;
    Scene scene;
    scene.builder.quad("floor", vec3(-8, 0, 8), vec3(16, 0, 0), vec3(0, 0, -16), assets::diffuse(vec3(0.5f)));
    scene.builder.box("pane", vec3(-8, 1.2f, -8), vec3(8, 1.2f + float(thickness), 8), clear_glass());
    scene.builder.point_light("lamp", vec3(0, float(height), 0), vec3(float(intensity)));
    scene.finish();
    scene.settings.bounces = 2; // both surfaces, and no reflections within the pane
    scene.camera.position = vec3(0.0f, 1.1f, 0.0f);
    scene.camera.target = vec3(0.0f);
    scene.camera.up = vec3(0.0f, 0.0f, -1.0f);
    scene.camera.vertical_field_of_view = 2.0f * std::atan(1.5f / 1.1f);
    const auto place = [&](double a) {
        const double b = std::asin(std::sin(a) / 1.5);
        return (height - thickness) * std::tan(a) + thickness * std::tan(b);
    };
    const auto irradiance = [&](double x) {
        double low = 0.0, high = 1.55;
        for (int i = 0; i < 60; ++i)
            (place(0.5 * (low + high)) < x ? low : high) = 0.5 * (low + high);
        const double a = low, step = 1e-5, slope = (place(a + step) - place(a - step)) / (2.0 * step);
        const double passed = 1.0 - fresnel(std::cos(a), 1.5);
        return intensity * passed * passed * std::sin(a) / (x * slope);
    };
    const Accumulation picture = scene.picture(*scene.from_light, by_size(2048u, 32768u));
    // Rings about the axis: in each the mean over pixels, of about as many particles.
    std::map<int, std::pair<double, double>> rings;
    for (std::size_t i = 0; i < picture.counts.size(); ++i) {
        double expected = 0.0, distance = 0.0; // over the pixel
        for (int s = 0; s < 16; ++s) {
            const double x = double(i % 24) + (s % 4 + 0.5) / 4 - 12.0, y = double(i / 24) + (s / 4 + 0.5) / 4 - 8.0;
            distance = std::hypot(x, y) * 1.5 / 8.0;
            expected += irradiance(distance) / 16.0;
        }
        auto& [found, truth] = rings[int(distance / 0.5)];
        found += picture.sums[i * 3] / picture.samples;
        truth += expected;
    }
    for (const auto& [ring, light] : rings) {
        std::printf("%.1f to %.1f m: %.4f\n", 0.5 * ring, 0.5 * (ring + 1), light.first / light.second);
        EXPECT_NEAR(light.first / light.second, 1.0, by_size(0.01, 0.003)) << 0.5 * ring;
    }
    for (const double sum : scene.picture(*scene.from_camera, 16).sums)
        ASSERT_EQ(sum, 0.0);
}

// A lamp within glass, which light leaves by refraction but does not enter: the squared index of refraction does not
// cancel, and stands in the particles for what the path tracer leaves out of radiance. Few paths find most of the
// light, so that errors of blocks are not normally distributed: more standard errors are allowed.
TEST(LightTracer, ALampWithinGlassIsThatOfThePathTracer) {
    Scene scene;
    furnish(scene);
    scene::Material glow;
    glow.emission = vec3(12, 9, 5);
    const scene::Transform place = aimed(vec3(0.5f, 1.9f, 0.6f), vec3(0));
    scene.builder.add("lamp", scene::make_sphere(0.2f, 32, 16), glow, place);
    scene.builder.box("glass", place.position - vec3(0.4f), place.position + vec3(0.4f), clear_glass());
    scene.finish();
    scene.settings.bounces = 4;
    expect_same_light(scene, by_size(128u, 2048u), "a lamp within glass", {by_size(0.02, 0.008), 8.0});
}

// All that is seen is what a white ball of 24 triangles reflects, whose shading normals are up to 45 degrees off
// theirs.
TEST(LightTracer, ShadingNormalsReflectAsInThePathTracer) {
    Scene scene;
    const scene::Material black = assets::diffuse(vec3(0.0f));
    scene.builder.quad("floor", vec3(-3, 0, 3), vec3(6, 0, 0), vec3(0, 0, -6), black);
    scene.builder.quad("back", vec3(-3, 0, -1), vec3(6, 0, 0), vec3(0, 3, 0), black);
    scene.builder.add("ball", scene::make_sphere(0.6f, 6, 3), assets::diffuse(vec3(1.0f)),
                      aimed(vec3(0, 0.8f, 0), vec3(0)));
    scene.builder.spot_light("lamp", aimed(vec3(1.5f, 2.5f, 1.5f), vec3(0, 0.8f, 0)), {vec3(20.0f), 0.2f, 0.25f});
    scene.finish();
    scene.settings.bounces = 1;
    scene.settings.view = ReferenceView::indirect;
    scene.camera.position = vec3(0.5f, 2.0f, 3.0f);
    scene.camera.target = vec3(0.0f, 0.5f, -0.3f);
    expect_same_light(scene, by_size(512u, 8192u), "a coarse ball", {by_size(0.01, 0.003)});
}

// A panel's light through a ball of glass with shading normals, which scattered rays of the path tracer find, too.
TEST(LightTracer, APanelThroughAGlassBallIsThatOfThePathTracer) {
    Scene scene;
    furnish(scene);
    scene.builder.ceiling_light("lamp", vec3(-0.2f, 2.9f, 0.6f), 1.2f, 1.2f, vec3(9.0f));
    scene.builder.add("glass", scene::make_sphere(0.5f, 64, 32), clear_glass(), aimed(vec3(0.5f, 0.9f, 0.9f), vec3(0)));
    scene.finish();
    scene.settings.bounces = 2;
    expect_same_light(scene, by_size(64u, 1024u), "a panel through a glass ball", {by_size(0.012, 0.003)});
}

// The brightest 40 cm of the caustic within `ring`, from above: what the metal reflects to the plate.
struct Ring : Scene {
    Ring() {
        assets::make_ring(builder);
        finish();
        settings.view = ReferenceView::indirect;
        settings.bounces = 1;
        settings.width = settings.height = 16;
        camera.position = vec3(-0.22f, 1.2f, -0.06f);
        camera.target = vec3(-0.22f, 0.0f, -0.06f);
        camera.up = vec3(0.0f, 0.0f, -1.0f);
        camera.vertical_field_of_view = 0.33f;
    }
    // Luminance, W/m2.
    template <typename Tracer>
    std::vector<double> caustic(const Tracer& tracer, std::uint32_t samples, std::uint32_t seed) {
        settings.seed = seed;
        const Accumulation sums = picture(tracer, samples);
        std::vector<double> light(sums.counts.size());
        for (std::size_t i = 0; i < light.size(); ++i)
            light[i] = double(luminance(vec3(sums.sums[i * 3], sums.sums[i * 3 + 1], sums.sums[i * 3 + 2]))) / samples;
        return light;
    }
};

// Its energy, where it is above its mean. Which pixels these are is judged by a picture of its own: noise would choose
// those in which it adds light. One of some 1,000 paths from the camera finds the lobe of the gloss, and light tracing
// has an error much smaller than theirs, which is printed: the bounds are some two of it.
TEST(LightTracer, TheRingsCausticHasThePathTracersEnergy) {
    Ring ring;
    const std::uint32_t samples = by_size(2048u, 32768u);
    const std::vector<double> where = ring.caustic(*ring.from_light, 2048, 99);
    const double mean = std::accumulate(where.begin(), where.end(), 0.0) / double(where.size());
    const auto energy = [&](const auto& tracer, std::uint32_t paths, std::uint32_t seed) {
        const std::vector<double> light = ring.caustic(tracer, paths, seed);
        double sum = 0.0;
        for (std::size_t i = 0; i < light.size(); ++i)
            sum += where[i] > mean ? light[i] : 0.0;
        return sum;
    };
    constexpr std::uint32_t pictures = 4;
    double sum = 0.0, squares = 0.0;
    for (std::uint32_t seed = 1; seed <= pictures; ++seed) {
        const double ratio = energy(*ring.from_light, samples / 2, seed) / energy(*ring.from_camera, samples, seed);
        sum += ratio / pictures;
        squares += ratio * ratio / pictures;
    }
    const double error = std::sqrt(std::max(squares - sum * sum, 0.0) / (pictures - 1));
    std::printf("caustic's energy: %+.2f %% (standard error %.2f %%)\n", 100.0 * (sum - 1.0), 100.0 * error);
    EXPECT_NEAR(sum, 1.0, by_size(0.04, 0.01));
}

} // namespace
} // namespace sunfleck::gi::reference

// Light gathered from reflective shadow maps: with each texel it is the sum of all pixel lights, with some of them it
// is that in the mean over seeds.
#include "gi_module/rsm_gather/rsm_gather_technique.h"
#include "tests/support/summed_pixel_lights.h"
#include "tests/support/techniques.h"
#include "tests/support/test_size.h"

#include <cmath>
#include <limits>

namespace sunfleck::tests {
namespace {

class RsmGather : public GpuTest {
protected:
    // Nothing but the first bounce.
    static gi::Settings alone(std::uint32_t samples, std::uint32_t rays) {
        gi::Settings settings;
        settings.lights = 4;
        settings.low_resolution = 1;
        settings.bounces = 1;
        settings.with("direct", "none").with("punctual", "none").with("gather_lights", "all");
        return settings.with("gather_samples", std::to_string(samples)).with("gather_rays", std::to_string(rays));
    }
    static const gi::GatherMaps& maps(GpuWorld& world) {
        return dynamic_cast<gi::RsmGatherTechnique*>(world.renderer->lighting().technique("rsm_gather"))->maps();
    }
};

TEST_F(RsmGather, WithEveryTexelIsTheSumOfAllPixelLights) {
    for (const auto make : {assets::make_cornell, assets::make_arena}) {
        GpuWorld world(make, "view");
        world.set(alone(65536, 1024));
        const io::Picture picture = world.picture();
        const std::vector<gi::PixelLight> lights = maps(world).pixel_lights();
        ASSERT_GT(lights.size(), 200u);
        EXPECT_GE(share_of_equal_pixels(picture, summed_light(world, lights, gi::splat_clamp_scale)), 0.99);
        // Fewer are another picture: the comparison can fail.
        world.set(alone(64, 1024));
        EXPECT_LT(share_of_equal_pixels(world.picture(), summed_light(world, lights, gi::splat_clamp_scale)), 0.5);
    }
}

// The same as all texels of the same maps as splatted lights.
TEST_F(RsmGather, WithEveryTexelIsSplattedLight) {
    if (!has_technique("splatting"))
        GTEST_SKIP() << "there is no splatting";
    GpuWorld world(assets::make_cornell, "view");
    world.set(alone(65536, 1024));
    const io::Picture gathered = world.picture();
    gi::Settings splats = alone(1, 16).with("gather_lights", "none").with("splat_lights", "all");
    splats.with("splats", "1024").with("splat_rays", "1024").with("splat_occlusion", "none");
    world.set(splats.with("splat_pattern", "fixed").with("splat_importance", "none"));
    const io::Picture splatted = world.picture();
    std::vector<vec3> expected;
    for (const vec4& pixel : splatted.pixels)
        expected.emplace_back(pixel);
    EXPECT_GE(share_of_equal_pixels(gathered, expected), 0.995);
}

struct Mean {
    double sum = 0.0, squares = 0.0;
    int count = 0;
    void add(double value) { sum += value, squares += value * value, ++count; }
    double mean() const { return sum / count; }
    double deviation() const { // of the mean
        return std::sqrt(std::max(squares / count - mean() * mean(), 0.0) / count);
    }
};

// Luminance of the picture's 12 blocks of 16 x 16 pixels.
std::vector<double> blocks_of(const io::Picture& picture) {
    std::vector<double> blocks(12, 0.0);
    for (std::uint32_t y = 0; y < 48; ++y)
        for (std::uint32_t x = 0; x < 64; ++x)
            blocks[y / 16 * 4 + x / 16] += double(luminance(vec3(picture.pixels[y * 64 + x]))) / 256.0;
    return blocks;
}

TEST_F(RsmGather, EstimatesAreUnbiasedOverSeeds) {
    GpuWorld world(assets::make_cornell, "view");
    world.set(alone(65536, 1024));
    const std::vector<double> expected = blocks_of(world.picture());
    std::vector<Mean> found(expected.size());
    for (std::uint32_t seed = 1; seed <= by_size(60u, 400u); ++seed) {
        gi::Settings settings = alone(64, 1024);
        settings.seed = seed;
        world.set(settings);
        const std::vector<double> blocks = blocks_of(world.picture());
        for (std::size_t i = 0; i < blocks.size(); ++i)
            found[i].add(blocks[i]);
    }
    for (std::size_t i = 0; i < expected.size(); ++i) {
        EXPECT_LT(found[i].deviation(), 0.03 * expected[i]) << "block " << i << ": too noisy to tell";
        EXPECT_NEAR(found[i].mean(), expected[i], 4.0 * found[i].deviation() + 0.002 * expected[i]) << "block " << i;
    }
}

// Blended from every fourth pixel, and gathered again where that fails.
TEST_F(RsmGather, LowResolutionStaysNearFull) {
    GpuWorld world(assets::make_arena, "view");
    world.request.width = 160;
    world.request.height = 90;
    gi::Settings settings = alone(256, 4096);
    world.set(settings);
    const io::Picture full = world.picture();
    settings.low_resolution = 4;
    world.set(settings);
    const io::Picture low = world.picture();
    double difference = 0.0, all = 0.0;
    for (std::size_t i = 0; i < full.pixels.size(); ++i) {
        difference += double(luminance(glm::abs(vec3(full.pixels[i]) - vec3(low.pixels[i]))));
        all += double(luminance(vec3(full.pixels[i])));
    }
    EXPECT_LT(difference, 0.05 * all);
    EXPECT_GT(difference, 0.0);
}

// Fixed and dynamic light alone, with the samples of both, add up to both.
TEST_F(RsmGather, PartsAddUp) {
    GpuWorld world(assets::make_arena, "view");
    const auto picture = [&](const char* plan) {
        world.set(alone(200, 4096).with("sampled_light", "all").with("plan", plan));
        return world.picture();
    };
    const io::Picture both = picture(""), fixed = picture("first_bounce.dynamic=none"),
                      dynamic = picture("first_bounce.fixed=none");
    double lit[2] = {0.0, 0.0};
    for (std::size_t i = 0; i < both.pixels.size(); ++i) {
        const vec3 sum = vec3(fixed.pixels[i]) + vec3(dynamic.pixels[i]);
        EXPECT_LE(glm::length(sum - vec3(both.pixels[i])), 0.003f * glm::length(sum) + 1e-5f) << "pixel " << i;
        lit[0] += double(luminance(vec3(fixed.pixels[i])));
        lit[1] += double(luminance(vec3(dynamic.pixels[i])));
    }
    EXPECT_GT(lit[0], 0.0);
    EXPECT_GT(lit[1], 0.0);
}

TEST_F(RsmGather, DefectiveEmittersAreDark) {
    for (const float bad : {0.0f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        GpuWorld world;
        assets::SceneBuilder scene(world.renderer->registry(), world.renderer->meshes());
        const vec3 albedo(0.6f);
        scene.room(vec3(-2), vec3(2), albedo, albedo, {albedo, albedo, albedo, albedo});
        scene.point_light("bad", vec3(0.5f), vec3(bad));
        scene.point_light("outside", vec3(0.0f, 2.5f, 0.0f), vec3(5.0f)); // sees nothing
        scene.camera("view", vec3(1.5f, 0.0f, 0.0f), vec3(0.0f, 0.0f, -1.0f), 70.0f);
        world.finish("view");
        world.set(alone(64, 4096));
        for (const vec4& pixel : world.picture().pixels) {
            ASSERT_TRUE(is_finite(vec3(pixel)));
            EXPECT_LE(luminance(vec3(pixel)), 0.0f);
        }
    }
}

} // namespace
} // namespace sunfleck::tests

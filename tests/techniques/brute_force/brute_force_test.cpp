// Brute force: what its bound takes away, its kernel's shapes, more samples than shadow maps.
#include "gi_module/brute_force/brute_force_settings.h"
#include "tests/support/gpu_world.h"
#include "tests/support/test_size.h"

namespace sunfleck::tests {
namespace {

class BruteForceTest : public GpuTest {};

// Irradiance / pi = e (1 - a^(B+1)) / (1 - a), once what the bound of the geometry term took away is given back. The
// short size takes a dark and a bright furnace of five.
TEST_F(BruteForceTest, FurnaceWithinThreePercent) {
    const float albedos[] = {0.3f, 0.9f, 0.1f, 0.5f, 0.7f};
    for (const float albedo : std::span(albedos).first(by_size(2u, 5u)))
        for (const std::uint32_t bounces : by_size(std::vector{0u, 5u}, {0u, 1u, 5u})) {
            GpuWorld world;
            assets::SceneBuilder builder(world.renderer->registry(), world.renderer->meshes());
            assets::make_furnace_of(builder, albedo, 1.0f);
            world.finish("view");
            gi::Settings settings = gi::Settings().all_light_by("brute_force");
            settings.lights = 16384;
            settings.direct_share = 0.5f;
            settings.bounces = bounces;
            settings.of<gi::BruteForceSettings>().count_clamped = true;
            settings.shadow_map_resolution = 32;
            world.set(settings);
            world.request.width = 32;
            world.request.height = 24;
            const io::Picture picture = world.picture();
            world.render(); // the counter arrives with the next frame
            double mean = 0;
            for (const vec4& pixel : picture.pixels)
                mean += double(pixel.x) / double(picture.pixels.size());
            const double clamped = world.renderer->lighting().counters()["clamped_irradiance"];
            double expected = 0, power = 1;
            for (std::uint32_t k = 0; k <= bounces; ++k, power *= double(albedo))
                expected += power;
            EXPECT_NEAR((mean + clamped) / double(pi) / expected, 1.0, 0.03) << "albedo " << albedo << " B " << bounces;
        }
}

TEST_F(BruteForceTest, WhatTheBoundTakesAwayIsCounted) {
    GpuWorld world(assets::make_furnace, "view");
    gi::Settings settings = gi::Settings().all_light_by("brute_force");
    settings.lights = 512;
    settings.direct_share = 0.5f;
    settings.of<gi::BruteForceSettings>().count_clamped = true;
    settings.clamp_scale = 0.1f; // clamps much
    world.set(settings);
    world.request.width = 128;
    world.request.height = 96;
    const auto mean = [&] {
        double sum = 0;
        const io::Picture picture = world.picture();
        for (const vec4& pixel : picture.pixels)
            sum += double(pixel.x) / double(picture.pixels.size());
        return sum;
    };
    const double clamped_mean = mean();
    world.render();
    const double counted = world.renderer->lighting().counters()["clamped_irradiance"];
    EXPECT_GT(world.renderer->lighting().counters()["clamped_flux"], 0.0);
    settings.clamp_scale = 1e6f; // hardly any
    world.set(settings);
    const double free_mean = mean();
    EXPECT_GT(counted, 0.02 * free_mean);
    EXPECT_NEAR((clamped_mean + counted) / free_mean, 1.0, 1e-3);
}

// The two kernels' shapes and slot sharing must not change the picture.
TEST_F(BruteForceTest, EveryKernelShapeGivesTheSamePicture) {
    GpuWorld world(assets::make_four_pillars, "view");
    world.request.width = 100; // not a multiple of any tile
    world.request.height = 37;
    gi::Settings settings = gi::Settings().all_light_by("brute_force");
    settings.lights = 70;
    settings.shadow_map_resolution = 64;
    world.set(settings);
    const io::Picture expected = world.picture();
    double total = 0;
    for (const vec4& pixel : expected.pixels)
        total += double(pixel.x);
    EXPECT_GT(total, 100.0);
    for (const char* pixels : {"1", "2", "4", "8", "16"})
        for (const char* maps : {"texel", "storage"})
            for (const char* lights : {"uniform", "storage"}) {
                settings.with("kernel_pixels", pixels).with("kernel_maps", maps).with("kernel_lights", lights);
                world.set(settings);
                const io::Picture picture = world.picture();
                int different = 0;
                for (std::size_t i = 0; i < picture.pixels.size(); ++i)
                    if (glm::length(vec3(picture.pixels[i] - expected.pixels[i])) >
                        2e-3f * (1.0f + glm::length(vec3(expected.pixels[i]))))
                        ++different;
                EXPECT_LE(different, 4) << pixels << " " << maps << " " << lights;
            }
}

TEST_F(BruteForceTest, FewerSlotsThanSamplesGiveTheSamePicture) {
    GpuWorld world(assets::make_cornell, "corner");
    gi::Settings settings = gi::Settings().all_light_by("brute_force");
    settings.lights = 100;
    settings.shadow_map_resolution = 256;
    world.set(settings);
    const io::Picture expected = world.picture();
    settings.shadow_memory = 2.0f; // 16 slots of 128 KiB
    world.set(settings);
    GpuWorld small(assets::make_cornell, "corner");
    small.set(settings);
    const io::Picture picture = small.picture();
    EXPECT_EQ(small.renderer->lighting().shadows().maps().slots(), 16u);
    for (std::size_t i = 0; i < picture.pixels.size(); ++i)
        ASSERT_LE(glm::length(vec3(picture.pixels[i] - expected.pixels[i])),
                  2e-3f * (1.0f + glm::length(vec3(expected.pixels[i]))));
}

TEST_F(BruteForceTest, AnyNumberOfSamples) {
    for (const std::uint32_t lights : {0u, 1u, 7u, 300u, 2049u, by_size(8193u, 65536u)}) {
        GpuWorld world(assets::make_cornell, "view");
        gi::Settings settings = gi::Settings().all_light_by("brute_force");
        settings.lights = lights;
        settings.shadow_map_resolution = 16;
        world.set(settings);
        world.request.width = 24;
        world.request.height = 16;
        const io::Picture picture = world.picture();
        EXPECT_EQ(world.renderer->lighting().counters()["light_samples"], lights);
        double sum = 0;
        for (const vec4& pixel : picture.pixels) {
            ASSERT_TRUE(is_finite(vec3(pixel)));
            sum += double(pixel.x);
        }
        EXPECT_EQ(sum > 0.0, lights > 0);
    }
}

} // namespace
} // namespace sunfleck::tests

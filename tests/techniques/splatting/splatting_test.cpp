// Splatted light: each pixel gets what all pixel lights give it, cells of the light plan add up to the picture, and
// whatever emitters there are, there is a picture.
#include "editor/command_line/metrics.h"
#include "gi_module/splatting/splatting_technique.h"
#include "tests/support/summed_pixel_lights.h"
#include "tests/support/techniques.h"
#include "tests/support/test_size.h"
#include "tests/techniques/splatting/evaluations.h"

#include <cmath>
#include <limits>
#include <map>

namespace sunfleck::tests {
namespace {

class SplatTechnique : public GpuTest {
protected:
    static gi::Settings splatted(const char* lights, int count) {
        gi::Settings settings;
        settings.lights = 60;
        settings.shadow_map_resolution = 64;
        settings.map_budget = 65536;
        settings.low_resolution = 1;
        settings.with("splat_lights", lights).with("splats", std::to_string(count));
        set_if_known(settings, "baked_light", "off");
        return settings;
    }
    // Nothing but the first bounce, without its shadows.
    static gi::Settings alone(int count) {
        gi::Settings settings = splatted("all", count);
        settings.with("direct", "none").with("punctual", "none").with("plan", "later_bounces=none");
        return settings.with("splat_occlusion", "none");
    }
    static const gi::SplatLights& lights(GpuWorld& world) {
        return dynamic_cast<gi::SplattingTechnique*>(world.renderer->lighting().technique("splatting"))->lights();
    }
};

TEST_F(SplatTechnique, ItsSettingFillsCellsOfThePlan) {
    const auto owner = [](const gi::Settings& settings, gi::LightCell cell) {
        const std::int32_t index = settings.light_plan().value().owner(cell);
        return index == gi::nobody ? "none" : std::string(gi::techniques()[std::size_t(index)].name);
    };
    const gi::LightCell moving{gi::PathPart::first_bounce, true, false, false},
        fixed{gi::PathPart::first_bounce, false, false, false}, later{gi::PathPart::later_bounces, true, false, false};
    EXPECT_NE(owner(gi::Settings(), moving), "splatting");
    gi::Settings settings = gi::Settings().with("splat_lights", "moving");
    EXPECT_EQ(owner(settings, moving), "splatting");
    EXPECT_NE(owner(settings, fixed), "splatting");
    settings.with("splat_lights", "all");
    EXPECT_EQ(owner(settings, fixed), "splatting");
    EXPECT_NE(owner(settings, later), "splatting");
    // What is nobody's stays nobody's, and exceptions have the last word.
    EXPECT_EQ(owner(gi::Settings(settings).with("indirect", "none"), moving), "none");
    EXPECT_EQ(owner(gi::Settings(settings).with("plan", "first_bounce.dynamic=none"), moving), "none");
    if (has_technique("prt")) {
        settings.with("movers", "prt");
        EXPECT_EQ(owner(settings, {gi::PathPart::first_bounce, true, true, false}), "prt");
        EXPECT_TRUE(settings.validate());
    }
}

// Of a picture whose lights end at a threshold: in how many pixels is all light that a light gives above it?
double share_that_keeps(const io::Picture& cut, const std::vector<vec3>& above) {
    std::size_t kept = 0, all = 0;
    for (std::size_t i = 0; i < above.size(); ++i)
        if (cut.pixels[i].w > 0.0f) {
            ++all;
            kept += glm::all(glm::greaterThanEqual(vec3(cut.pixels[i]), 0.995f * above[i] - 1e-5f));
        }
    return double(kept) / double(all);
}

// 300: two batches.
TEST_F(SplatTechnique, EveryPixelGetsTheSumOfAllPixelLights) {
    GpuWorld world(assets::make_cornell, "view");
    gi::Settings settings = alone(300);
    world.set(settings);
    const io::Picture picture = world.picture();
    ASSERT_GT(lights(world).lights().size(), 260u);
    EXPECT_GE(share_of_equal_pixels(picture, summed_light(world, lights(world).lights(), gi::splat_clamp_scale)), 0.99);
    // With a bound, what is left out is below the threshold: at most that of each light.
    settings.with("splat_cutoff", "0.02");
    world.set(settings);
    const io::Picture cut = world.picture();
    const float most = 0.02f * lights(world).mean_irradiance() * float(lights(world).lights().size());
    double removed = 0.0, all = 0.0;
    for (std::size_t i = 0; i < cut.pixels.size(); ++i) {
        const vec3 less = vec3(picture.pixels[i]) - vec3(cut.pixels[i]);
        EXPECT_LE(std::max({less.x, less.y, less.z}), most + 0.002f * luminance(vec3(picture.pixels[i])));
        EXPECT_GE(std::min({less.x, less.y, less.z}), -0.002f * luminance(vec3(picture.pixels[i])) - 1e-5f);
        removed += double(luminance(less));
        all += double(luminance(vec3(picture.pixels[i])));
    }
    EXPECT_GE(share_that_keeps(cut, summed_light(world, lights(world).lights(), gi::splat_clamp_scale,
                                                 0.02f * lights(world).mean_irradiance())),
              0.99);
    EXPECT_GT(removed, 0.001 * all) << "the threshold cuts nothing";
    EXPECT_LT(removed, 0.3 * all);
}

// Lights that are dimmed reach less far.
TEST_F(SplatTechnique, AmbientOcclusionSavesEvaluations) {
    GpuWorld world(assets::make_cornell, "view");
    world.request.lighting_view = "overdraw";
    const auto evaluations = [&](const char* occlusion) {
        world.set(
            alone(300).with("splat_cutoff", "0.1").with("splat_ambient_reach", "2").with("splat_occlusion", occlusion));
        double sum = 0.0;
        for (const vec4& pixel : world.picture().pixels)
            sum += double(pixel.x);
        return sum;
    };
    const double all = evaluations("none"), dimmed = evaluations("ambient");
    std::printf("evaluations with ambient occlusion: %.3f of those without\n", dimmed / all);
    EXPECT_LT(dimmed, 0.97 * all);
    EXPECT_GT(dimmed, 0.0);
}

// A ring of polished metal: lobes of thousands, and a curved surface whose lights shine past each other.
TEST_F(SplatTechnique, EveryPixelGetsTheSumOfAllLobes) {
    GpuWorld world(assets::make_ring, "view");
    gi::Settings settings = alone(100).with("glossy_splats", "500").with("splat_footprints", "off");
    world.set(settings);
    const io::Picture picture = world.picture();
    const auto all = lights(world).lights();
    EXPECT_GT(std::count_if(all.begin(), all.end(), [](const gi::PixelLight& light) { return light.exponent > 50.0f; }),
              100);
    EXPECT_GE(share_of_equal_pixels(picture, summed_light(world, all, gi::splat_clamp_scale)), 0.98);
    settings.with("splat_cutoff", "0.05");
    world.set(settings);
    const io::Picture cut = world.picture();
    const float least = 0.05f * lights(world).mean_irradiance();
    EXPECT_GE(share_that_keeps(cut, summed_light(world, lights(world).lights(), gi::splat_clamp_scale, least)), 0.98);
    EXPECT_LT(share_of_equal_pixels(cut, summed_light(world, lights(world).lights(), gi::splat_clamp_scale)), 0.9)
        << "the threshold cuts nothing";
}

TEST(SplatBlocks, AreFourByTwoPixelsOfAGroup) {
    std::map<std::uint32_t, std::uint32_t> block_of;
    for (std::uint32_t block = 0; block < shared::splat_blocks; ++block) {
        const std::uint32_t first = shared::splat_block_entry(block, 0);
        for (std::uint32_t pixel = 0; pixel < shared::splat_block_pixels; ++pixel) {
            const std::uint32_t entry = shared::splat_block_entry(block, pixel);
            EXPECT_LT(entry, shared::pixel_group_size);
            EXPECT_TRUE(block_of.emplace(entry, block).second) << entry;
            EXPECT_EQ(entry % 8 - first % 8, pixel % 4);
            EXPECT_EQ(entry / 8 - first / 8, pixel / 4);
        }
    }
}

class SplatLobes : public SplatTechnique {
protected:
    // All that reflects is metal, its lobes about the mirror direction.
    void open(float exponent) {
        world.request.width = 320;
        world.request.height = 180;
        std::vector<ecs::Entity> all;
        world.renderer->registry().view<scene::Material>().each(
            [&](ecs::Entity entity, const scene::Material&) { all.push_back(entity); });
        for (const ecs::Entity entity : all)
            world.renderer->registry().patch<scene::Material>(entity, [&](scene::Material& material) {
                material.metallic = 1.0f;
                material.roughness = std::pow(0.5f / exponent, 0.25f);
            });
    }
    static gi::Settings lobes(const char* cutoff) {
        gi::Settings settings = alone(0).with("glossy_splats", "256").with("splat_footprints", "off");
        return settings.with("splat_cutoff", cutoff).with("splat_pattern", "fixed");
    }

    GpuWorld world{assets::make_arena, "bench_1"};
};

// Of pixels that get light above the threshold, all are evaluated, and of others few: whole groups of 64 pixels have
// 3.4 and 6.9 evaluations for each.
TEST_F(SplatLobes, AreLeftOutOfBlocksOfPixelsWhereTheyAreFaint) {
    for (const auto& [exponent, most] : {std::pair(50.0f, 1.8), std::pair(1000.0f, 2.9)}) {
        open(exponent);
        world.set(lobes("0.05"));
        const io::Picture picture = world.picture();
        const std::span<const gi::PixelLight> shown = lights(world).lights();
        const float least = 0.05f * lights(world).mean_irradiance();
        EXPECT_GE(share_that_keeps(picture, summed_light(world, shown, gi::splat_clamp_scale, least)), 0.98);
        const double above = pairs_above(world, shown, gi::splat_clamp_scale, least), done = evaluations(world);
        std::printf("exponent %g: %.2f evaluations for each above the threshold\n", double(exponent), done / above);
        EXPECT_LT(done, most * above);
        EXPECT_GE(done, 0.99 * above);
    }
}

// A threshold that nothing is below cuts nothing, in the pixels of the first pass and in repaired ones.
TEST_F(SplatLobes, OfBlocksAreAllWhereNoneIsFaint) {
    open(200.0f);
    for (const std::uint32_t scale : {1u, 4u}) {
        gi::Settings all = lobes("0"), blocks = lobes("1e-7");
        all.low_resolution = blocks.low_resolution = scale;
        world.set(all);
        const io::Picture expected = world.picture();
        world.set(blocks);
        EXPECT_LT(command_line::compare_pictures(world.picture(), expected, true).relative_mean_square_error, 1e-6);
        EXPECT_EQ(world.renderer->lighting().counters()["pixels_repaired"] > 0.0, scale > 1);
    }
}

// At a quarter of the resolution, with repair, in one set of sums with light samples.
TEST_F(SplatTechnique, LowResolutionStaysNearFull) {
    GpuWorld world(assets::make_arena, "view");
    world.request.width = 160;
    world.request.height = 90;
    world.request.step = 10;
    gi::Settings settings = splatted("moving", 128);
    settings.with("splat_occlusion", "none");
    world.set(settings);
    const io::Picture full = world.picture();
    settings.low_resolution = 4;
    world.set(settings);
    const auto metrics = command_line::compare_pictures(world.picture(), full, true);
    EXPECT_LT(metrics.relative_mean_square_error, 0.01);
    EXPECT_GT(world.renderer->lighting().counters()["splats"], 100.0);
}

// A room in whose middle nothing is lets all light through: the path tracer's first bounce has a closed form for its
// sum over the walls. All of a white room's light arrives again: flux over area, albedo once.
TEST_F(SplatTechnique, InAnEmptyRoomTheFirstBounceHasItsClosedFormMean) {
    GpuWorld world;
    assets::SceneBuilder scene(world.renderer->registry(), world.renderer->meshes());
    const vec3 albedo(0.6f, 0.5f, 0.4f);
    scene.room(vec3(-2), vec3(2), albedo, albedo, {albedo, albedo, albedo, albedo});
    scene.point_light("bulb", vec3(0.0f), vec3(3.0f));
    scene.camera("view", vec3(0.0f), vec3(0.0f, 0.0f, -1.0f), 90.0f);
    world.finish("view");
    world.request.width = world.request.height = 64;
    world.set(alone(16384).with("splat_rays", "65536"));
    const io::Picture picture = world.picture();
    // The camera stands in the middle, so one wall fills the picture, each of whose points has an area of 1 / cos^3 of
    // a pixel's solid angle: in the mean over the wall's area, each pixel counts alike. All six walls are the same.
    vec3 sum(0.0f);
    for (const vec4& pixel : picture.pixels)
        sum += vec3(pixel);
    const vec3 mean = sum / float(picture.pixels.size()), expected = 4.0f * pi * 3.0f * albedo / 96.0f;
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(mean[c], expected[c], 0.01f * expected[c]); // what the clamp takes in the edges
}

// Each pair of path and motion alone, with the samples of the whole.
TEST_F(SplatTechnique, CellsAddUpToThePicture) {
    // Pixel lights that are followed depend on the frames before: each picture has a world of its own.
    const auto picture = [&](const gi::Settings& settings) {
        GpuWorld world(assets::make_arena, "view");
        world.request.width = 96;
        world.request.height = 72;
        world.set(settings);
        world.request.step = 74;
        world.render();
        world.request.step = 75;
        return world.picture();
    };
    for (const char* choice : {"moving", "all"}) {
        gi::Settings settings = splatted(choice, 200);
        settings.with("sampled_light", "all").with("punctual", "light_samples");
        const io::Picture whole = picture(settings);
        io::Picture sum = whole;
        for (vec4& pixel : sum.pixels)
            pixel *= vec4(0.0f, 0.0f, 0.0f, 1.0f);
        for (const char* path : {"punctual", "direct", "first_bounce", "later_bounces"})
            for (const char* motion : {"fixed", "dynamic"}) {
                gi::Settings one = settings;
                for (const char* other : {"punctual", "direct", "first_bounce", "later_bounces"})
                    for (const char* kind : {"fixed", "dynamic"})
                        if (std::string(path) != other || std::string(motion) != kind)
                            one.plan += (one.plan.empty() ? "" : ",") + std::string(other) + "." + kind + "=none";
                const io::Picture part = picture(one);
                for (std::size_t i = 0; i < sum.pixels.size(); ++i)
                    sum.pixels[i] += vec4(vec3(part.pixels[i]), 0.0f);
            }
        const double error = command_line::compare_pictures(sum, whole, true).relative_mean_square_error;
        std::printf("%s: %.1e\n", choice, error);
        EXPECT_LT(error, 1e-6) << choice;
    }
}

void expect_finite(const io::Picture& picture) {
    for (const vec4& pixel : picture.pixels)
        ASSERT_TRUE(is_finite(vec3(pixel))) << "a pixel is not a number";
}

// Numbers of splats at the limits, and emitters that are none.
TEST_F(SplatTechnique, EveryNumberOfPixelLightsGivesAPicture) {
    GpuWorld world(assets::make_cornell, "view");
    for (const int count : {0, 1, 255, 257, 65536}) {
        world.set(alone(count));
        const io::Picture picture = world.picture();
        expect_finite(picture);
        EXPECT_LE(world.renderer->lighting().counters()["splats"], double(count));
        const auto lit = std::count_if(picture.pixels.begin(), picture.pixels.end(),
                                       [](const vec4& pixel) { return luminance(vec3(pixel)) > 0.0f; });
        EXPECT_EQ(lit > 0, count > 0) << count;
    }
}

TEST_F(SplatTechnique, DefectiveEmittersAreDark) {
    for (const float bad :
         {0.0f, -1.0f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        GpuWorld world;
        assets::SceneBuilder scene(world.renderer->registry(), world.renderer->meshes());
        const vec3 albedo(0.6f);
        scene.room(vec3(-2), vec3(2), albedo, albedo, {albedo, albedo, albedo, albedo});
        scene.point_light("bad", vec3(0.5f), vec3(bad));
        scene.point_light("in a wall", vec3(0.0f, 2.5f, 0.0f), vec3(5.0f)); // outside: sees nothing
        scene.camera("view", vec3(1.5f, 0.0f, 0.0f), vec3(0.0f, 0.0f, -1.0f), 70.0f);
        world.finish("view");
        world.set(alone(64));
        const io::Picture picture = world.picture();
        expect_finite(picture);
        for (const vec4& pixel : picture.pixels)
            EXPECT_LE(luminance(vec3(pixel)), 0.0f);
    }
}

// Lamps that move, more than there are pixel lights: those that have one stand for the others.
TEST_F(SplatTechnique, AThousandLampsShareOneBudget) {
    GpuWorld world;
    assets::SceneBuilder scene(world.renderer->registry(), world.renderer->meshes());
    const vec3 albedo(0.6f);
    scene.room(vec3(-2), vec3(2), albedo, albedo, {albedo, albedo, albedo, albedo});
    const int lamps = by_size(128, 1024);
    for (int i = 0; i < lamps; ++i) {
        const int row = i / 32, column = i % 32;
        scene.mover(scene.point_light("lamp", vec3(0.03f * float(column) - 0.5f, 0.0f, 0.03f * float(row) - 0.5f),
                                      vec3(4.0f / float(lamps))),
                    {});
    }
    scene.camera("view", vec3(0.0f), vec3(0.0f, 0.0f, -1.0f), 90.0f);
    world.finish("view");
    gi::Settings settings = alone(64);
    settings.lights = 2 * std::uint32_t(lamps);
    world.set(settings);
    const io::Picture picture = world.picture();
    expect_finite(picture);
    EXPECT_LE(world.renderer->lighting().counters()["splats"], 64.0);
    EXPECT_GT(world.renderer->lighting().counters()["splats"], 32.0);
    EXPECT_EQ(world.renderer->lighting().counters()["reflective_maps"], double(lamps));
    double flux = 0.0; // of a scene whose unit is not 1 m, in other units
    for (const gi::PixelLight& light : lights(world).lights())
        flux += double(light.flux.x) * std::pow(double(world.renderer->space().unit), 2.0);
    const double expected = 4.0 * 4.0 * 3.14159265 * 0.6;
    EXPECT_NEAR(flux, expected, 0.02 * expected);
}

// 56 lamps are shut up in the boxes of the gallery, 8 are in the hall. Whoever is seen gets the lights.
TEST_F(SplatTechnique, LampsInShutRoomsGetHardlyAnyLights) {
    GpuWorld world;
    assets::SceneBuilder scene(world.renderer->registry(), world.renderer->meshes());
    assets::make_arena(scene);
    const auto lamp = [&](vec3 place) { scene.mover(scene.point_light("one of many", place, vec3(5.0f)), {}); };
    for (int i = 0; i < 56; ++i)
        lamp(i < 40 ? vec3(-7.4f + 0.37f * float(i), 0.8f, -6.7f) : vec3(-6.7f, 0.8f, -5.0f + 0.5f * float(i - 40)));
    for (int i = 0; i < 8; ++i)
        lamp(vec3(-3.5f + float(i), 3.0f, 4.0f));
    world.finish("bench_1");
    gi::Settings settings = alone(512);
    settings.lights = 256;
    settings.with("splat_rays", "65536"); // so that each lamp sees enough texels
    std::map<std::string, double> shut_share;
    for (const char* importance : {"flux", "contribution"}) {
        world.set(gi::Settings(settings).with("splat_importance", importance));
        expect_finite(world.picture());
        double shut = 0.0;
        const auto all = lights(world).lights();
        for (const gi::PixelLight& light : all) {
            const vec3 at = light.position * world.renderer->space().unit + world.renderer->space().origin;
            shut += at.y < 1.599f && ((at.z < -5.401f && std::abs(at.x) < 7.999f) ||
                                      (at.x < -5.401f && at.x > -7.999f && at.z < 3.999f))
                        ? 1.0
                        : 0.0;
        }
        EXPECT_GT(all.size(), 400u);
        shut_share[importance] = shut / double(all.size());
        std::printf("%s: %.3f of the lights in shut rooms\n", importance, shut_share[importance]);
    }
    EXPECT_LT(shut_share["contribution"], 0.02);
    EXPECT_GT(shut_share["flux"], 0.2);
}

} // namespace
} // namespace sunfleck::tests

// The error of splatted light against all texels of the reflective shadow map as lights: how it falls with the number
// of lights, what the contribution to the picture saves, and how little it changes from frame to frame.
#include "editor/command_line/flicker_meter.h"
#include "editor/command_line/metrics.h"
#include "tests/support/gpu_world.h"
#include "tests/support/test_size.h"

#include <cmath>

namespace sunfleck::tests {
namespace {

class SplatError : public GpuTest {
protected:
    void open(void (*make)(assets::SceneBuilder&), const char* camera) {
        world = std::make_unique<GpuWorld>();
        assets::SceneBuilder builder(world->renderer->registry(), world->renderer->meshes());
        make(builder);
        for (const char* lamp : {"ceiling lamp 0", "ceiling lamp 1"})
            if (const ecs::Entity entity = scene::find_by_name(world->renderer->registry(), lamp);
                world->renderer->registry().has<scene::AreaLight>(entity) && make == assets::make_arena)
                world->renderer->registry().patch<scene::AreaLight>(
                    entity, [](scene::AreaLight& light) { light.radiance = vec3(0.0f); });
        world->finish(camera);
        settings.lights = 4;
        settings.low_resolution = 1;
        settings.bounces = 1;
        settings.with("direct", "none").with("punctual", "none").with("splat_lights", "all");
        settings.with("splat_rays", "16384").with("splat_occlusion", "none");
    }
    // Every texel a pixel light: a Sobol pattern of as many points has one in each.
    gi::Settings limit() const {
        gi::Settings all = settings;
        all.with("splat_importance", "none").with("splat_pattern", "fixed");
        return all.with("splats", "65536").with("splat_rays", "65536");
    }
    io::Picture picture(const gi::Settings& now) {
        world->set(now);
        return world->picture();
    }
    gi::Settings way(const char* pattern, const char* importance, std::uint32_t count, std::uint32_t seed = 1) const {
        gi::Settings now = settings;
        now.seed = seed;
        now.with("splat_pattern", pattern).with("splat_importance", importance);
        return now.with("splats", std::to_string(count)).with("splat_rays", "65536");
    }
    double mean_error(const io::Picture& expected, const char* pattern, const char* importance, std::uint32_t count) {
        double sum = 0.0;
        const std::uint32_t seeds = by_size(2u, 5u);
        for (std::uint32_t seed = 1; seed <= seeds; ++seed)
            sum += command_line::compare_pictures(picture(way(pattern, importance, count, seed)), expected, true)
                       .relative_mean_square_error;
        return sum / seeds;
    }
    double slope(const io::Picture& expected, const char* pattern, const char* importance) {
        double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
        for (const std::uint32_t count : {64u, 256u, 1024u, 4096u}) {
            const double error = mean_error(expected, pattern, importance, count);
            std::printf("%u pixel lights: E %.5f\n", count, error);
            const double x = std::log(double(count)), y = std::log(error);
            n += 1, sx += x, sy += y, sxx += x * x, sxy += x * y;
        }
        const double result = (n * sxy - sx * sy) / (n * sxx - sx * sx);
        std::printf("%s, %s: log-log slope %.3f\n", pattern, importance, result);
        return result;
    }
    command_line::FlickerMeter measured(const gi::Settings& now, const std::vector<io::Picture>& limits,
                                        std::uint64_t first, bool lamp, float orbit) {
        command_line::FlickerMeter meter;
        world->set(now);
        for (std::size_t i = 0; i < limits.size(); ++i)
            meter.add(at_step(first + (lamp ? i : 0), orbit * float(i)), limits[i]);
        return meter;
    }
    io::Picture at_step(std::uint64_t step, float orbit) {
        world->request.step = step;
        if (orbit != 0.0f) {
            if (!start)
                start = world->request.camera;
            world->request.camera = start->orbited(glm::radians(orbit));
        }
        return world->picture();
    }

    std::unique_ptr<GpuWorld> world;
    std::optional<scene::CameraView> start;
    gi::Settings settings;
};

TEST_F(SplatError, FallsWithTheNumberOfPixelLightsInTheArena) {
    open(assets::make_arena, "bench_1");
    const io::Picture all = picture(limit());
    EXPECT_LE(slope(all, "fixed", "none"), -0.8);
    EXPECT_LE(slope(all, "followed", "flux"), -0.75); // at less than half the error
}

TEST_F(SplatError, FallsWithTheNumberOfPixelLightsInTheCornellBox) {
    open(assets::make_cornell, "view");
    // Corners are all over the picture: nearer to them than lights are apart, errors fall with that distance alone.
    EXPECT_LE(slope(picture(limit()), "followed", "flux"), -0.6);
}

TEST_F(SplatError, LightsThatContributeToThePictureCutIt) {
    open(assets::make_arena, "bench_1");
    const io::Picture all = picture(limit());
    const double uniform = mean_error(all, "fixed", "none", 256), flux = mean_error(all, "fixed", "flux", 256),
                 contribution = mean_error(all, "followed", "contribution", 256);
    std::printf("E of 256 lights: uniform %.5f, flux %.5f, contribution %.5f\n", uniform, flux, contribution);
    EXPECT_LT(contribution, uniform / 3.0);
}

// A polished ring, by what it reflects in lobes alone. Chosen by flux times exponent, and in the shape of the beams
// that its curved surface reflects.
TEST_F(SplatError, BeamsCutThatOfACaustic) {
    open(assets::make_ring, "view");
    settings.with("splats", "0").with("splat_footprints", "off");
    const auto glossy = [&](const char* importance, const char* footprints, const char* count, const char* rays) {
        gi::Settings now = settings;
        now.with("splat_importance", importance).with("splat_footprints", footprints);
        return picture(now.with("glossy_splats", count).with("splat_rays", rays));
    };
    const io::Picture all = glossy("none", "off", "65536", "65536"), beams = glossy("none", "on", "65536", "65536");
    const auto error = [&](const io::Picture& found, const io::Picture& expected) {
        return command_line::compare_pictures(found, expected, true).relative_mean_square_error;
    };
    const double uniform = error(glossy("none", "off", "2048", "65536"), all),
                 warped = error(glossy("flux", "off", "2048", "65536"), all),
                 shaped = error(glossy("flux", "on", "2048", "65536"), beams);
    std::printf(
        "E of 2,048 lobes: uniform %.4f, flux x exponent %.4f, beams %.4f (to eq. 3: %.4f); limits differ %.4f\n",
        uniform, warped, shaped, error(glossy("flux", "on", "2048", "65536"), all), error(beams, all));
    EXPECT_LT(warped, uniform);
    EXPECT_LT(shaped, warped);
}

// The lamp goes its way between two piers: its light changes everywhere in every step.
TEST_F(SplatError, HardlyChangesWhileTheLampMoves) {
    open(assets::make_arena, "bench_1");
    const std::uint64_t first = 180;
    world->set(limit());
    std::vector<io::Picture> limits;
    for (int i = 0; i <= by_size(16, 120); ++i)
        limits.push_back(at_step(first + std::uint64_t(i), 0.0f));
    const auto followed = measured(way("followed", "flux", 1024), limits, first, true, 0.0f),
               fixed = measured(way("fixed", "none", 1024), limits, first, true, 0.0f);
    std::printf("followed: F %.4f, E %.5f; fixed: F %.4f, E %.5f\n", followed.flicker(), followed.error(),
                fixed.flicker(), fixed.error());
    // How much a limit of a quarter of the texels changes says what is the limit's own.
    const auto coarse =
        measured(limit().with("splats", "16384").with("splat_rays", "16384"), limits, first, true, 0.0f);
    std::printf("change: followed %.2e, fixed %.2e, of a coarser limit %.2e\n", followed.change(), fixed.change(),
                coarse.change());
    EXPECT_LE(followed.change(), 0.5 * fixed.change());
    EXPECT_LE(followed.error(), 1.25 * fixed.error());
}

TEST(SplatFlickerMeter, IsOneForNoiseAndNoneForAnErrorThatStays) {
    std::uint32_t state = 1;
    const auto uniform = [&] { return float((state = state * 1664525u + 1013904223u) >> 8) * 0x1p-24f; };
    command_line::FlickerMeter noise, still;
    for (int frame = 0; frame < 20; ++frame) {
        io::Picture limit{32, 32, {}}, noisy, shifted;
        for (int i = 0; i < 1024; ++i)
            limit.pixels.emplace_back(vec3(1.0f + 0.1f * float(i % 7)), i % 5 == 0 ? 0.0f : 1.0f);
        noisy = shifted = limit;
        for (int i = 0; i < 1024; ++i) {
            noisy.pixels[std::size_t(i)] += vec4(vec3(uniform() - 0.5f), 0.0f);
            shifted.pixels[std::size_t(i)] += vec4(vec3(0.2f), 0.0f);
        }
        noise.add(noisy, limit);
        still.add(shifted, limit);
    }
    EXPECT_NEAR(noise.flicker(), 1.0, 0.1);
    EXPECT_NEAR(still.flicker(), 0.0, 1e-6);
    EXPECT_GT(still.error(), 0.001);
}

} // namespace
} // namespace sunfleck::tests

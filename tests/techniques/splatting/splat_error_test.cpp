// How the error of splatted light falls with the number of pixel lights, against all texels of the reflective shadow
// map as lights.
#include "editor/command_line/metrics.h"
#include "tests/support/gpu_world.h"
#include "tests/support/test_size.h"

#include <cmath>

namespace sunfleck::tests {
namespace {

class SplatError : public GpuTest {
protected:
    void open(void (*make)(assets::SceneBuilder&), const char* camera) {
        world = std::make_unique<GpuWorld>(make, camera);
        settings.lights = 4;
        settings.low_resolution = 1;
        settings.bounces = 1;
        settings.with("direct", "none").with("punctual", "none").with("splat_lights", "all");
        settings.with("splat_rays", "65536").with("splat_occlusion", "none");
    }
    // Every texel a pixel light: a Sobol pattern of as many points has one in each.
    io::Picture limit(float clamp_scale) {
        gi::Settings all = settings;
        all.clamp_scale = clamp_scale;
        all.with("splat_importance", "none");
        return picture(all.with("splats", "65536").with("splat_rays", "65536"));
    }
    io::Picture picture(const gi::Settings& now) {
        world->set(now);
        return world->picture();
    }
    // The limit, over those pixels that no light of it clamps.
    io::Picture judged_limit(double least_share) {
        io::Picture all = limit(1.0f);
        const io::Picture unclamped = limit(1e5f);
        std::size_t judged = 0, lit = 0;
        for (std::size_t i = 0; i < all.pixels.size(); ++i) {
            lit += all.pixels[i].w > 0.0f;
            const float difference = glm::length(vec3(all.pixels[i]) - vec3(unclamped.pixels[i]));
            if (difference > 1e-3f * glm::length(vec3(all.pixels[i])))
                all.pixels[i].w = 0.0f;
            judged += all.pixels[i].w > 0.0f;
        }
        EXPECT_GE(double(judged), least_share * double(lit));
        return all;
    }
    double mean_error(const io::Picture& judged, std::uint32_t count, std::uint32_t seeds) {
        double sum = 0.0;
        for (std::uint32_t seed = 1; seed <= seeds; ++seed) {
            gi::Settings now = settings;
            now.seed = seed;
            now.with("splats", std::to_string(count));
            sum += command_line::compare_pictures(picture(now), judged, true).relative_mean_square_error;
        }
        return sum / seeds;
    }
    void expect_slope(double shallowest_allowed) {
        const io::Picture judged = judged_limit(0.9);
        double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
        for (const std::uint32_t count : {64u, 256u, 1024u, 4096u}) {
            const double error = mean_error(judged, count, by_size(3u, 5u));
            std::printf("%u pixel lights: E %.5f\n", count, error);
            const double x = std::log(double(count)), y = std::log(error);
            n += 1, sx += x, sy += y, sxx += x * x, sxy += x * y;
        }
        const double slope = (n * sxy - sx * sy) / (n * sxx - sx * sx);
        std::printf("log-log slope %.3f\n", slope);
        EXPECT_LE(slope, shallowest_allowed);
    }

    std::unique_ptr<GpuWorld> world;
    gi::Settings settings;
};

TEST_F(SplatError, FallsWithTheNumberOfPixelLightsInTheArena) {
    open(assets::make_arena, "bench_1");
    expect_slope(-0.8);
}

} // namespace
} // namespace sunfleck::tests

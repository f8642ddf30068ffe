// What "right" means: brute force with many samples is the path tracer's picture.
#include "tests/support/gpu_world.h"
#include "tests/support/test_size.h"

#include "editor/command_line/metrics.h"
#include "engine/simulation/path_movers.h"
#include "gi_module/reference/path_tracer.h"
#include "gi_module/reference/surface_distance.h"

#include <cmath>

namespace sunfleck::tests {
namespace {

using namespace gi::reference;

class Truth : public GpuTest {};

io::Picture reference_picture(GpuWorld& world, std::uint32_t samples) {
    viewer::SceneRenderer& renderer = *world.renderer;
    simulation::set_movers_to_step(renderer.registry(), 0);
    EXPECT_TRUE(renderer.rays().update(renderer.registry(), renderer.meshes()));
    const Bounds bounds = viewer::scene_bounds(renderer.registry(), renderer.meshes());
    const PathTracer tracer(renderer.rays(), gi::collect_emitters(renderer.registry(), renderer.meshes(), bounds));
    ReferenceSettings settings;
    settings.width = world.request.width;
    settings.height = world.request.height;
    settings.view = ReferenceView::irradiance;
    Accumulation accumulation;
    tracer.accumulate(accumulation, world.request.camera, settings, samples);
    io::Picture picture{settings.width, settings.height, {}};
    for (std::size_t i = 0; i < accumulation.covered.size(); ++i)
        picture.pixels.emplace_back(
            float(accumulation.sums[i * 3] / samples), float(accumulation.sums[i * 3 + 1] / samples),
            float(accumulation.sums[i * 3 + 2] / samples), accumulation.covered[i] ? 1.0f : 0.0f);
    return picture;
}

gi::Settings truth_settings(std::uint32_t lights, std::uint32_t seed) {
    gi::Settings settings = gi::Settings().all_light_by("brute_force");
    settings.lights = lights;
    settings.seed = seed;
    settings.direct_share = 0.5f;
    settings.with("movers", "static");
    return settings;
}

// Mean irradiance within 1 %, relative MSE at most 0.01, over all pixels: also those near other surfaces, where the
// bound of the geometry term acts. (Four thousand paths a pixel leave about 0.1 % of noise in the reference's mean.)
// The short size has an eighth of the paths, 0.3 % of noise, and an eighth of the samples; the bounds, several times
// what is measured, hold for it, too.
void expect_truth(void (*make)(assets::SceneBuilder&)) {
    GpuWorld world(make, "view");
    world.request.width = 80;
    world.request.height = 60;
    const io::Picture truth = reference_picture(world, by_size(512u, 4096u));
    world.set(truth_settings(by_size(2048u, 16384u), 1));
    const io::Picture picture = world.picture();
    const auto metrics = command_line::compare_pictures(picture, truth, true);
    std::printf("mean %.4f of %.4f (%+.2f %%), relative MSE %.4f, %llu pixels\n", metrics.mean_a, metrics.mean_b,
                100.0 * (metrics.mean_a / metrics.mean_b - 1.0), metrics.relative_mean_square_error,
                (unsigned long long)metrics.pixels);
    EXPECT_NEAR(metrics.mean_a / metrics.mean_b, 1.0, 0.01);
    EXPECT_LE(metrics.relative_mean_square_error, 0.01);
    EXPECT_GT(metrics.pixels, 3000u);
}

TEST_F(Truth, Cornell) {
    expect_truth(assets::make_cornell);
}
TEST_F(Truth, AreaRoom) {
    expect_truth(assets::make_area_room);
}
TEST_F(Truth, FourPillars) {
    expect_truth(assets::make_four_pillars);
}

// A yard under a uniform sky and a sun: light from outside, through orthographic maps.
TEST_F(Truth, SkyAndSun) {
    expect_truth([](assets::SceneBuilder& scene) {
        scene.quad("ground", vec3(-3, 0, -3), vec3(0, 0, 6), vec3(6, 0, 0), assets::diffuse(vec3(0.6f, 0.5f, 0.4f)));
        scene.box("block", vec3(-0.6f, 0, -0.6f), vec3(0.6f, 1.2f, 0.6f), assets::diffuse(vec3(0.7f)));
        scene.quad("wall", vec3(-2.5f, 0, -2.0f), vec3(5, 0, 0), vec3(0, 2, 0),
                   assets::diffuse(vec3(0.2f, 0.4f, 0.7f)));
        ecs::Registry& registry = scene.registry();
        registry.emplace<scene::Environment>(registry.create(), {vec3(0.5f, 0.6f, 0.8f)});
        const ecs::Entity sun = registry.create();
        scene::Transform transform;
        transform.rotation = assets::facing(vec3(0.5f, 1.0f, 0.6f));
        registry.emplace<scene::Transform>(sun, transform);
        registry.emplace<scene::DirectionalLight>(sun, {vec3(2.0f, 1.9f, 1.6f)});
        scene.camera("view", vec3(2.2f, 2.4f, 2.9f), vec3(-0.2f, 0.5f, -0.4f), 55.0f);
    });
}

// The error falls with the number of samples, five seeds each. The pixels are the same at every count: those farther
// from other surfaces than 1/sqrt(G_max) at the smallest one, where no sample is ever clamped. (Nearer to other
// surfaces the variance of point samples is unbounded but for the clamp, which rises with the count: there the slope is
// about -0.3.) The short size leaves out the largest number, where the reference's noise begins to count, and two
// seeds.
TEST_F(Truth, ErrorFallsWithTheNumberOfSamples) {
    GpuWorld world(assets::make_cornell, "view");
    world.request.width = 48;
    world.request.height = 36;
    const io::Picture truth = reference_picture(world, by_size(2048u, 4096u));
    const std::vector<float> distances = surface_distances(world.renderer->rays(), world.request.camera, 48, 36);
    double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
    std::vector<std::uint8_t> counted;
    std::size_t counted_pixels = 0;
    const std::uint32_t counts[] = {256, 1024, 4096, 16384}, seeds = by_size(3u, 5u);
    for (const std::uint32_t lights : std::span(counts).first(by_size(3u, 4u))) {
        std::vector<double> errors;
        for (std::uint32_t seed = 1; seed <= seeds; ++seed) {
            gi::Settings settings = truth_settings(lights, seed);
            settings.shadow_map_resolution = 128;
            settings.with("kernel_pixels", "4"); // tiles fit the picture
            world.set(settings);
            io::Picture picture = world.picture();
            if (counted.empty())
                for (const float distance : distances) {
                    counted.push_back(distance >
                                      1.0f / std::sqrt(world.renderer->lighting().sample_set().geometry_bound()));
                    counted_pixels += counted.back();
                }
            for (std::size_t i = 0; i < counted.size(); ++i)
                if (!counted[i])
                    picture.pixels[i].w = 0.0f;
            errors.push_back(command_line::compare_pictures(picture, truth, true).root_mean_square_error);
        }
        std::sort(errors.begin(), errors.end());
        const double x = std::log(double(lights)), y = std::log(errors[seeds / 2]);
        n += 1, sx += x, sy += y, sxx += x * x, sxy += x * y;
        std::printf("%u samples: RMSE %.4f\n", lights, errors[seeds / 2]);
    }
    const double slope = (n * sxy - sx * sy) / (n * sxx - sx * sx);
    std::printf("log-log slope %.3f\n", slope);
    EXPECT_LE(slope, -0.4);
    EXPECT_GT(counted_pixels, 300u);
}

} // namespace
} // namespace sunfleck::tests

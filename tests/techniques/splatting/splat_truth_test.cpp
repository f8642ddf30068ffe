// Splatted light with its shadows against the path tracer's first bounce.
#include "editor/command_line/metrics.h"
#include "gi_module/reference/path_tracer.h"
#include "tests/support/gpu_world.h"
#include "tests/support/test_size.h"

namespace sunfleck::tests {
namespace {

using namespace gi::reference;

class SplatTruth : public GpuTest {
protected:
    // With its ceiling lamps, or the lamp that moves alone.
    void open(bool ceiling_lamps) {
        assets::SceneBuilder scene(world.renderer->registry(), world.renderer->meshes());
        assets::make_arena(scene);
        for (const char* lamp : {"ceiling lamp 0", "ceiling lamp 1"})
            if (!ceiling_lamps)
                switch_off(scene::find_by_name(world.renderer->registry(), lamp));
        crate = scene.box("dropped crate", vec3(-0.7f), vec3(0.7f), assets::diffuse(vec3(0.5f)));
        scene.mover(crate, {});
        put_crate(vec3(0.0f, 30.0f, 0.0f)); // out of sight
        world.finish("bench_1");
        world.request.width = 64;
        world.request.height = 36;
    }
    // The path tracer finds a lamp by its surface, too.
    void switch_off(ecs::Entity lamp) {
        world.renderer->registry().patch<scene::AreaLight>(
            lamp, [](scene::AreaLight& light) { light.radiance = vec3(0.0f); });
        world.renderer->registry().patch<scene::Material>(
            lamp, [](scene::Material& surface) { surface.emission = vec3(0.0f); });
    }
    void put_crate(vec3 place) {
        world.renderer->registry().patch<scene::Transform>(
            crate, [&](scene::Transform& transform) { transform.position = place; });
    }
    static gi::Settings splatted(const char* occlusion) {
        gi::Settings settings;
        settings.lights = 4;
        settings.low_resolution = 1;
        settings.with("direct", "none").with("punctual", "none").with("plan", "later_bounces=none");
        return settings.with("splat_lights", "all").with("splats", "1024").with("splat_occlusion", occlusion);
    }
    // After some frames, so that the crate comes as a surprise.
    io::Picture picture(const gi::Settings& settings, vec3 place) {
        world.set(settings);
        put_crate(vec3(0.0f, 30.0f, 0.0f));
        world.render();
        world.render();
        put_crate(place);
        return world.picture();
    }
    io::Picture truth(std::uint32_t samples) {
        viewer::SceneRenderer& renderer = *world.renderer;
        scene::update_world_transforms(renderer.registry());
        EXPECT_TRUE(renderer.rays().update(renderer.registry(), renderer.meshes()));
        const Bounds bounds = viewer::scene_bounds(renderer.registry(), renderer.meshes());
        const PathTracer tracer(renderer.rays(), gi::collect_emitters(renderer.registry(), renderer.meshes(), bounds));
        ReferenceSettings settings;
        settings.width = world.request.width;
        settings.height = world.request.height;
        settings.view = ReferenceView::indirect;
        settings.bounces = 1;
        Accumulation sums;
        tracer.accumulate(sums, world.request.camera, settings, samples);
        io::Picture result{settings.width, settings.height, {}};
        for (std::size_t i = 0; i < sums.covered.size(); ++i)
            result.pixels.emplace_back(
                vec3(float(sums.sums[i * 3]), float(sums.sums[i * 3 + 1]), float(sums.sums[i * 3 + 2])) /
                    float(samples),
                sums.covered[i] ? 1.0f : 0.0f);
        return result;
    }
    // `mean`: by how much that may differ from the path tracer's.
    void expect_a_fifth(vec3 place, double mean) {
        const io::Picture shadowed = picture(splatted("maps"), place), plain = picture(splatted("none"), place),
                          ambient = picture(splatted("ambient"), place);
        const io::Picture expected = truth(by_size(384u, 4096u));
        const auto with = command_line::compare_pictures(shadowed, expected, true),
                   without = command_line::compare_pictures(plain, expected, true),
                   modulated = command_line::compare_pictures(ambient, expected, true);
        std::printf("truth error: none %.4f, ambient %.4f, maps %.4f; mean %+.2f %%, none %+.2f %%\n",
                    without.relative_mean_square_error, modulated.relative_mean_square_error,
                    with.relative_mean_square_error, 100.0 * (with.mean_a / with.mean_b - 1.0),
                    100.0 * (without.mean_a / without.mean_b - 1.0));
        EXPECT_LE(with.relative_mean_square_error, 0.2 * without.relative_mean_square_error);
        EXPECT_LT(modulated.relative_mean_square_error, without.relative_mean_square_error);
        EXPECT_NEAR(with.mean_a / with.mean_b, 1.0, mean);
    }

    GpuWorld world;
    ecs::Entity crate;
};

// Without shadows, light comes through walls; with them, a fifth of the error at most is left, also in the very frame
// in which a crate has dropped in front of the lamp.
TEST_F(SplatTruth, ShadowsLeaveAFifthOfTheError) {
    open(true);
    expect_a_fifth(vec3(0.0f, 30.0f, 0.0f), 0.04);
    expect_a_fifth(vec3(1.9f, 2.6f, 0.4f), 0.04);
}

// A point light alone: without the area lights, whose maps have each texel start at another place.
TEST_F(SplatTruth, TheMeanOfOneLampIsThatOfThePathTracer) {
    open(false);
    expect_a_fifth(vec3(0.0f, 30.0f, 0.0f), 0.02);
}

} // namespace
} // namespace sunfleck::tests

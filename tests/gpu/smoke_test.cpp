// One frame of every scene and view: what the address and undefined-behaviour sanitizers see of GPU code.
#include "gi_module/brute_force/brute_force_settings.h"
#include "gi_module/many_light/many_light_settings.h"
#include "tests/support/gpu_world.h"

namespace sunfleck::tests {
namespace {

class Smoke : public GpuTest {};

TEST_F(Smoke, OneFrameOfEveryScene) {
    for (const assets::BuiltInScene& scene : assets::built_in_scenes()) {
        // Too large to be built twice under a sanitizer, and nothing in them that smaller ones have not.
        if (scene.name == "atrium" || scene.name == "gallery" || scene.name == "hall" || scene.name == "classroom")
            continue;
        for (const gi::Settings& technique : {gi::Settings().all_light_by("brute_force"), gi::Settings()}) {
            GpuWorld world(scene.make);
            gi::Settings settings = technique;
            settings.lights = 40;
            settings.shadow_map_resolution = 32;
            settings.of<gi::BruteForceSettings>().count_clamped = true;
            settings.of<gi::ManyLightSettings>().count_passes =
                std::string(scene.name) == "cornell"; // slow where patches are many
            settings.shadow_filter = true;
            world.set(settings);
            world.request.tone_map = true;
            world.request.show_samples = true;
            world.request.view = shared::view_final;
            double sum = 0;
            for (world.request.step = 0; world.request.step < 3; ++world.request.step)
                for (const vec4& pixel : world.picture().pixels)
                    sum += double(pixel.x);
            EXPECT_GT(sum, 30.0) << scene.name;
        }
    }
}

// Every false-colour view of the many-light system.
TEST_F(Smoke, FalseColours) {
    GpuWorld world(assets::make_four_pillars, "bench_1");
    gi::Settings settings;
    settings.lights = 40;
    settings.shadow_map_resolution = 32;
    world.set(settings);
    world.request.view = shared::view_false_colours;
    for (const gi::DebugView* view : gi::debug_views()) {
        world.request.lighting_view = view->name;
        double sum = 0;
        for (const vec4& pixel : world.picture().pixels)
            sum += double(pixel.x + pixel.y + pixel.z);
        EXPECT_GT(sum, 10.0) << view->name;
    }
}

} // namespace
} // namespace sunfleck::tests

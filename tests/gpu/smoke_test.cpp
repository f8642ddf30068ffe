// One frame of every scene and view: what the address and undefined-behaviour sanitizers see of GPU code.
#include "tests/support/gpu_world.h"
#include "tests/support/techniques.h"
#include "tests/support/test_size.h"

namespace sunfleck::tests {
namespace {

class Smoke : public GpuTest {};

class SmokeOf : public GpuTest, public testing::WithParamInterface<std::size_t> {};

// Short, without a sanitizer: two scenes, since other tests draw all of them there. With one, all but those that are
// too large to be built twice and have nothing in them that smaller ones have not.
bool is_drawn(std::string_view scene) {
    if (scene == "atrium" || scene == "gallery" || scene == "hall" || scene == "classroom")
        return false;
    return sanitized() || long_size() || scene == "cornell" || scene == "glass";
}

TEST_P(SmokeOf, OneFrame) {
    const assets::BuiltInScene& scene = assets::built_in_scenes()[GetParam()];
    if (!is_drawn(scene.name))
        GTEST_SKIP() << "not in this size";
    for (const std::string_view technique : techniques_for_all_light()) {
        GpuWorld world(scene.make);
        gi::Settings settings = gi::Settings().all_light_by(technique);
        settings.lights = 40;
        settings.shadow_map_resolution = 32;
        set_if_known(settings, "count_clamped", "on");
        if (scene.name == "cornell") // slow where patches are many
            set_if_known(settings, "count_passes", "on");
        settings.shadow_filter = true;
        world.set(settings);
        world.request.tone_map = true;
        world.request.show_samples = true;
        world.request.view = shared::view_final;
        double sum = 0;
        for (world.request.step = 0; world.request.step < 3; ++world.request.step)
            for (const vec4& pixel : world.picture().pixels)
                sum += double(pixel.x);
        EXPECT_GT(sum, 30.0) << technique;
    }
}
INSTANTIATE_TEST_SUITE_P(Scenes, SmokeOf, testing::Range(std::size_t(0), assets::built_in_scenes().size()),
                         [](const auto& instance) {
                             return std::string(assets::built_in_scenes()[instance.param].name);
                         });

// Every false-colour view.
TEST_F(Smoke, FalseColours) {
    GpuWorld world(assets::make_four_pillars, "bench_1");
    gi::Settings settings;
    settings.lights = 40;
    settings.shadow_map_resolution = 32;
    set_if_known(settings, "splat_lights", "all"); // views of whoever takes cells only by a setting of its own
    world.set(settings);
    world.request.view = shared::view_false_colours;
    if (gi::debug_views().empty())
        GTEST_SKIP() << "no technique of this build has views";
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

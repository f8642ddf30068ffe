// Light maps of surface patches: none lost, and no drift.
#include "gi_module/many_light/many_light_settings.h"
#include "tests/support/settled_pictures.h"
#include "tests/support/test_size.h"
#include "tests/techniques/many_light/many_light.h"

#include <random>

namespace sunfleck::tests {
namespace {

std::vector<std::int32_t> read_texels(GpuWorld& world, const gi::LightMaps& maps) {
    const std::uint64_t bytes = maps.counters().texels * 16;
    const gpu::Buffer target = read_back(world, maps.texels(), bytes);
    std::vector<std::int32_t> values(std::size_t(bytes) / 4);
    std::memcpy(values.data(), target.mapped(), bytes);
    return values;
}

void scatter(ecs::Registry& registry, const std::vector<ecs::Entity>& boxes, std::mt19937& random) {
    const auto uniform = [&](float low, float high) { return low + (high - low) * float(random() >> 8) * 0x1p-24f; };
    for (const ecs::Entity box : boxes)
        registry.patch<scene::Transform>(box, [&](scene::Transform& transform) {
            transform.position = vec3(uniform(-3, 3), uniform(0, 3), uniform(-3, 3));
            transform.rotation = glm::angleAxis(uniform(0, 6), vec3(0, 1, 0));
        });
}

void make_room_of_screens(assets::SceneBuilder& s) {
    const vec3 walls[4] = {vec3(0.6f, 0.1f, 0.1f), vec3(0.1f, 0.6f, 0.1f), vec3(0.6f), vec3(0.6f)};
    s.room(vec3(-3, 0, -3), vec3(3, 3, 3), vec3(0.6f), vec3(0.7f), walls, {{"lamp", vec2(0), 1.0f, 1.0f, vec3(20.0f)}});
    for (int i = 0; i < 10; ++i) {
        scene::Transform transform;
        transform.position = vec3(0.0f, 1.0f, 0.0f);
        const ecs::Entity box =
            s.add("box", scene::make_box(vec3(1.6f, 1.6f, 0.2f)), assets::diffuse(vec3(0.5f)), transform);
        s.mover(box, {});
    }
    s.camera("view", vec3(2.5f, 1.5f, 2.5f), vec3(0.0f, 1.0f, 0.0f), 60.0f);
}

// Boxes wander through a room for 5,000 changes of place, two million of light maps (a tenth in the short size); large
// ones hide whole patches from samples, so light maps change all the time. At the end they equal maps that know nothing
// of the past, to the last bit.
TEST_F(ManyLightTest, LightMapsNeverDrift) {
    GpuWorld world(make_room_of_screens, "view");
    gi::Settings settings;
    settings.lights = 100;
    settings.shadow_map_resolution = 16;
    world.set(settings);
    world.request.width = 16;
    world.request.height = 16;
    std::vector<ecs::Entity> boxes;
    world.renderer->registry().view<scene::Mover>().each(
        [&](ecs::Entity entity, const scene::Mover&) { boxes.push_back(entity); });
    ASSERT_EQ(boxes.size(), 10u);
    std::mt19937 random(21);
    std::uint64_t updates = 0;
    world.render();
    const int frames = by_size(50, 500);
    for (int frame = 0; frame < frames; ++frame) {
        scatter(world.renderer->registry(), boxes, random);
        world.render();
        updates += world.renderer->lighting().counters()["light_map_updates"];
    }
    std::printf("%llu light map updates\n", static_cast<unsigned long long>(updates));
    EXPECT_GT(updates, std::uint64_t(frames) * 20);
    const auto kept = read_texels(world, tests::many_light(world.renderer->lighting()).light_maps());
    // Another seed and back: samples, database and light maps are made again.
    settings.seed = 2;
    world.set(settings);
    world.render();
    settings.seed = 1;
    world.set(settings);
    world.render();
    const auto fresh = read_texels(world, tests::many_light(world.renderer->lighting()).light_maps());
    ASSERT_EQ(kept.size(), fresh.size());
    EXPECT_EQ(kept, fresh);
    EXPECT_NE(std::count_if(kept.begin(), kept.end(), [](std::int32_t v) { return v > 0; }), 0);
}

gi::Settings with_large_maps() {
    gi::Settings settings;
    settings.lights = 600;
    settings.clamp_scale = 8.0f; // small radius, fine texels
    settings.patch_levels = 0;
    settings.shadow_map_resolution = 32;
    settings.low_resolution = 1;
    return settings;
}

gi::Settings with_many_portions() {
    return with_large_maps().with("baked_light", "off");
}

std::uint64_t waiting(GpuWorld& world) {
    return world.renderer->lighting().counters()["light_maps_waiting"];
}

// With a budget for shadow maps, maps are summed over several frames, whose pictures are those of a scene without maps;
// then they are what one frame sums, to the bit.
TEST_F(ManyLightTest, LightMapsAreSummedInPortions) {
    GpuWorld at_once(assets::make_near_occluder, "view"), world(assets::make_near_occluder, "view"),
        bare(assets::make_near_occluder, "view");
    gi::Settings settings = with_many_portions();
    at_once.set(settings);
    world.set(settings);
    bare.set(settings.with("light_maps", "off"));
    world.request.map_budget = bare.request.map_budget = 1000;
    at_once.render();
    EXPECT_EQ(waiting(at_once), 0u);
    world.render();
    bare.render();
    const io::Picture before = world.picture();
    EXPECT_GT(waiting(world), 0u);
    expect_same_picture(before, bare.picture());
    int frames = 0;
    for (; waiting(world) > 0 && frames < 200; ++frames)
        world.render();
    EXPECT_GT(frames, 1);
    EXPECT_EQ(read_texels(world, tests::many_light(world.renderer->lighting()).light_maps()),
              read_texels(at_once, tests::many_light(at_once.renderer->lighting()).light_maps()));
}

// What changes meanwhile ends the portions: all is summed in the frame of the change.
TEST_F(ManyLightTest, ChangesEndThePortionsOfLightMaps) {
    std::vector<std::int32_t> texels[2];
    for (const bool portions : {false, true}) {
        GpuWorld world(make_room_of_screens, "view");
        gi::Settings settings = with_many_portions();
        settings.patch_levels = gi::Settings().patch_levels; // boxes hide whole patches
        world.set(settings);
        if (portions)
            world.request.map_budget = 1000;
        world.render();
        EXPECT_EQ(waiting(world) > 0, portions);
        std::vector<ecs::Entity> boxes;
        world.renderer->registry().view<scene::Mover>().each(
            [&](ecs::Entity entity, const scene::Mover&) { boxes.push_back(entity); });
        std::mt19937 random(21);
        for (int frame = 0; frame < 3; ++frame) { // too few for all portions
            scatter(world.renderer->registry(), boxes, random);
            world.render();
        }
        EXPECT_EQ(waiting(world), 0u);
        texels[portions] = read_texels(world, tests::many_light(world.renderer->lighting()).light_maps());
    }
    EXPECT_EQ(texels[0], texels[1]);
}

// Large patches with fine maps and many samples are many turns of a kernel's loops. Maps interpolate between texels, so
// that pixels differ a little; none may stay dark.
TEST_F(ManyLightTest, LargeLightMapsAreFilledToTheEnd) {
    GpuWorld world(assets::make_near_occluder, "view");
    world.request.width = 96;
    world.request.height = 72;
    gi::Settings settings = with_large_maps();
    world.set(settings);
    const io::Picture with = world.picture();
    EXPECT_GT(world.renderer->lighting().counters()["light_map_texels"], 100000u);
    settings.of<gi::ManyLightSettings>().light_maps = false;
    world.set(settings);
    const io::Picture without = world.picture();
    std::size_t dark = 0;
    double difference = 0, brightness = 0;
    for (std::size_t i = 0; i < with.pixels.size(); ++i) {
        const double a = double(luminance(vec3(with.pixels[i]))), b = double(luminance(vec3(without.pixels[i])));
        dark += b > 0.05 && a < 0.5 * b;
        difference += std::abs(a - b);
        brightness += b;
    }
    EXPECT_LT(dark, with.pixels.size() / 500);
    EXPECT_LT(difference, 0.03 * brightness);
}

// A bound that hardly bounds leaves steps that many samples' light is lost to: no texel is filled then.
TEST_F(ManyLightTest, NoLightIsLostToCoarseSteps) {
    GpuWorld world(assets::make_area_room, "bench_1");
    gi::Settings settings;
    settings.low_resolution = 1;
    settings.with("baked_light", "off");
    for (const float scale : {1.0f, 1e3f, 1e5f, 1e6f}) {
        settings.clamp_scale = scale;
        double mean[2] = {};
        for (const bool maps : {false, true}) {
            settings.of<gi::ManyLightSettings>().light_maps = maps;
            world.set(settings);
            for (const vec4& pixel : world.picture().pixels)
                mean[maps] += double(luminance(vec3(pixel)));
        }
        const double texels = world.renderer->lighting().counters()["light_map_texels"];
        std::printf("clamp_scale %g: %.0f texels, mean %+.3f %%\n", double(scale), texels,
                    100.0 * (mean[1] / mean[0] - 1.0));
        EXPECT_EQ(texels > 0.0, scale < 1e4f);
        EXPECT_NEAR(mean[1] / mean[0], 1.0, 0.01) << scale;
    }
}

} // namespace
} // namespace sunfleck::tests

// The many-light system against brute force: what each optimisation may change of the picture, and what it may not.
#include "gi_module/many_light/many_light_settings.h"
#include "tests/support/test_size.h"
#include "tests/techniques/many_light/brute_force_pair.h"

namespace sunfleck::tests {
namespace {

// Without what approximates (light maps, low resolution, simplified movers, a budget), only the order of sums differs
// from brute force: half a float's rounding of 16-bit output, and 200 float additions. With the database, pairs that it
// has settled skip the map's errors as well (false shadows in corners, light that the bias lets through under walls): a
// few pixels change, and no more than those errors are worth. The short size takes two of four scenes.
TEST_F(ManyLightTest, ExactPartsChangeNothing) {
    void (*const scenes[])(assets::SceneBuilder&) = {assets::make_table_room, assets::make_two_rooms,
                                                     assets::make_four_pillars, assets::make_near_occluder};
    for (auto make : std::span(scenes).first(by_size(2u, 4u))) {
        Pair pair(make, "bench_1");
        pair.size(160, 120);
        gi::Settings settings;
        settings.lights = 200;
        settings.of<gi::ManyLightSettings>().light_maps = false;
        settings.low_resolution = 1;
        settings.map_detail = false;
        settings.map_budget = 65536;
        for (const bool filter : {false, true})
            for (const bool visibility : {false, true}) {
                settings.shadow_filter = filter;
                settings.of<gi::ManyLightSettings>().visibility = visibility;
                pair.set(settings);
                pair.run_to(4, 0.25f);
                const Difference difference = compare(pair);
                const double rounding = 2e-3 * difference.mean_brightness + 2e-3;
                if (!visibility) {
                    EXPECT_LT(difference.largest, rounding) << "filter " << filter;
                } else {
                    // The database knows what is blocked at the edges of shadows, where filtered maps cannot tell a
                    // blocker from the other wall of a corner (surface_votes, octahedral_map.h): 0.0041.
                    const double share = filter ? 0.005 : 0.003;
                    EXPECT_LT(difference.mean, share * difference.mean_brightness) << "filter " << filter;
                    EXPECT_GT(pair.many.renderer->lighting().counters()["pairs_none"], 10000u);
                }
                EXPECT_GT(difference.mean_brightness, 0.01);
            }
    }
}

// A lantern is carried about and a lamp changes its strength: samples, database, maps and lists follow, and the picture
// is brute force's of the same samples (which have the same past: both worlds see every step). Pictures of the short
// size have a quarter of the pixels; the bound is on their mean.
TEST_F(ManyLightTest, FollowsLightsThatMoveAndVary) {
    Pair pair(assets::make_four_pillars, "bench_1");
    pair.size(by_size(160u, 320u), by_size(120u, 240u));
    ecs::Entity lanterns[2], lamps[2];
    int w = 0;
    for (GpuWorld* world : {&pair.brute, &pair.many}) {
        ecs::Registry& registry = world->renderer->registry();
        lanterns[w] = registry.create();
        registry.emplace<scene::Transform>(lanterns[w], {vec3(0.3f, 1.2f, 0.4f)});
        registry.emplace<scene::Mover>(lanterns[w], {scene::MoverPath::circle, vec3(1.0f), vec3(0.0f, 1.2f, 0.0f)});
        registry.emplace<scene::PointLight>(lanterns[w], {vec3(12.0f, 8.0f, 4.0f)});
        lamps[w++] = scene::find_by_name(registry, "lamp");
    }
    gi::Settings settings;
    settings.of<gi::ManyLightSettings>().light_maps = true;
    settings.low_resolution = 1;
    settings.map_detail = false;
    settings.map_budget = 65536;
    pair.set(settings);
    std::uint64_t moved = 0;
    const std::uint64_t phase = by_size(2u, 8u); // steps: the lamp is bright, dimmed, then out
    for (std::uint64_t step = 0; step < 3 * phase; ++step) {
        w = 0;
        for (GpuWorld* world : {&pair.brute, &pair.many}) {
            const ecs::Entity lamp = lamps[w++];
            const vec3 radiance(step < phase ? 17.0f : step < 2 * phase ? 6.0f : 0.0f);
            world->renderer->registry().patch<scene::AreaLight>(lamp,
                                                                [&](scene::AreaLight& l) { l.radiance = radiance; });
            world->renderer->registry().patch<scene::Material>(lamp,
                                                               [&](scene::Material& m) { m.emission = radiance; });
            world->request.step = step;
            world->render();
        }
        const gi::Report& counters = pair.many.renderer->lighting().counters();
        EXPECT_EQ(counters["light_samples"], 300u);
        if (step > phase)
            moved = std::max(moved, std::uint64_t(counters["light_samples_moved"]));
        EXPECT_EQ(counters["light_samples_dynamic"] > 0, true);
        if (step % phase != phase - 1)
            continue;
        const Difference difference = compare(pair);
        std::printf("step %d: mean %.5f of %.3f\n", int(step), difference.mean, difference.mean_brightness);
        EXPECT_LT(difference.mean, 0.006 * difference.mean_brightness);
        EXPECT_GT(difference.mean_brightness, 0.01);
    }
    EXPECT_GE(moved, 1u);
    EXPECT_LT(moved, 30u) << "only the moved light's own samples change";
}

// The whole system at 1024x768, tone-mapped: within 1/255 in the mean, half a per cent of pixels off by more than
// 8/255, and no block of 32x32 pixels off by more than 6/255 in its mean. The short size takes two cameras of seven,
// and the seventh frame in place of the 200th.
TEST_F(ManyLightTest, TheWholeSystemStaysCloseToBruteForce) {
    struct Case {
        void (*make)(assets::SceneBuilder&);
        const char* camera;
    };
    const Case cases[] = {{assets::make_table_room, "bench_1"},  {assets::make_four_pillars, "bench_2"},
                          {assets::make_cornell, "bench_1"},     {assets::make_area_room, "bench_1"},
                          {assets::make_area_room, "bench_2"},   {assets::make_table_room, "bench_2"},
                          {assets::make_four_pillars, "bench_1"}};
    for (const Case& c : std::span(cases).first(by_size(2u, 7u))) {
        Pair pair(c.make, c.camera);
        pair.size(1024, 768);
        pair.tone_map();
        pair.set(gi::Settings());
        pair.run_to(by_size(6u, 199u),
                    0.25f); // with the usual budget, so that most maps of moving things are some frames old
        const Difference difference = compare(pair);
        std::printf("%s: mean %.3f/255, %.3f%% beyond 8/255, worst block %.2f/255\n", c.camera, difference.mean * 255.0,
                    difference.beyond_8 * 100.0, difference.worst_block * 255.0);
        EXPECT_LT(difference.worst_block, 6.0 / 255.0);
        EXPECT_LT(difference.mean, 1.0 / 255.0);
        EXPECT_LT(difference.beyond_8, 0.005);
        pair.many.render(); // counters arrive a frame later
        const gi::Report& pixels = pair.many.renderer->lighting().counters();
        EXPECT_EQ(pixels["pixels_low_resolution"], 256u * 192u);
        EXPECT_GT(pixels["pixels_repaired"], 100u);
        EXPECT_LT(pixels["pixels_repaired"], 1024u * 768u / 20u);
        EXPECT_EQ(pixels["pixels_not_repaired"], 0u);
    }
}

void make_low_shelf(assets::SceneBuilder& s) {
    s.quad("floor", vec3(-4, 0, -8), vec3(0, 0, 16), vec3(8, 0, 0), assets::diffuse(vec3(0.5f)));
    s.quad("wall", vec3(-4, 0, -0.4f), vec3(8, 0, 0), vec3(0, 3, 0), assets::diffuse(vec3(0.5f)));
    s.box("board", vec3(-1.2f, 0.03f, -0.4f), vec3(1.2f, 0.06f, 0.0f), assets::diffuse(vec3(0.5f)));
    s.ceiling_light("lamp", vec3(0, 3, 3), 0.5f, 0.5f, vec3(50.0f));
    s.camera("view", vec3(0.5f, 1.6f, 8.0f), vec3(0.0f, 0.4f, 0.0f), 30.0f);
}

// The gap between a shelf and the floor is two to three pixels high, less than low-resolution pixels lie apart. It is
// as dark as at full resolution from end to end: of the pixels that are less than half as bright as the floor eight
// pixels below them, a fiftieth at most is lit as that floor. Without contacts' repair, many are.
TEST_F(ManyLightTest, AGapUnderAShelfIsDarkFromEndToEnd) {
    GpuWorld world(make_low_shelf, "view");
    world.request.width = 640;
    world.request.height = 360;
    gi::Settings settings;
    settings.lights = 128;
    settings.bounces = 0;
    settings.low_resolution = 1;
    world.set(settings);
    const io::Picture all = world.picture();
    settings.low_resolution = 4;
    const auto lost = [&](bool contacts) {
        settings.repair_contacts = contacts;
        world.set(settings);
        const io::Picture some = world.picture();
        int dark = 0, lit = 0;
        for (std::size_t i = 0; i + 8 * std::size_t(all.width) < all.pixels.size(); ++i) {
            const float floor = all.pixels[i + 8 * std::size_t(all.width)].g;
            if (all.pixels[i].a == 0.0f || all.pixels[i].g > 0.4f * floor)
                continue;
            ++dark;
            lit += some.pixels[i].g > 0.6f * floor;
        }
        std::printf("contacts %d: %d dark pixels, %d of them lit\n", int(contacts), dark, lit);
        EXPECT_GT(dark, 300);
        return double(lit) / double(dark);
    };
    EXPECT_LE(lost(true), 0.02);
    EXPECT_GE(lost(false), 0.1) << "otherwise this tests nothing";
}

void make_sinking_block(assets::SceneBuilder& s) {
    s.quad("floor", vec3(-4, 0, -4), vec3(0, 0, 8), vec3(8, 0, 0), assets::diffuse(vec3(0.5f)));
    s.ceiling_light("lamp", vec3(0, 3, 0), 0.5f, 0.5f, vec3(50.0f));
    const ecs::Entity block =
        s.box("block", vec3(-0.4f, 0.8f, -0.4f), vec3(0.4f, 1.2f, 0.4f), assets::diffuse(vec3(0.5f)));
    s.mover(block, {});
    s.camera("view", vec3(0.0f, 2.5f, 0.8f), vec3(0.0f, 1.2f, 0.0f), 20.0f);
}

// A block sinks away from its lamp while no map is redrawn: they show it where it was, nearer to the lamp, where it
// would shadow all of its own top.
TEST_F(ManyLightTest, NothingIsShadowedByWhereItWas) {
    Pair pair(make_sinking_block, "view");
    pair.size(64, 48);
    gi::Settings settings;
    settings.lights = 32;
    settings.bounces = 0;
    settings.low_resolution = 1;
    settings.map_budget = 0;
    pair.set(settings);
    for (int step = 0; step < 4; ++step)
        for (GpuWorld* world : {&pair.brute, &pair.many}) {
            ecs::Registry& registry = world->renderer->registry();
            world->request.simulate = false;
            registry.patch<scene::Transform>(scene::find_by_name(registry, "block"), [&](scene::Transform& transform) {
                transform.position.y = -0.04f * float(step);
            });
            scene::update_world_transforms(registry);
            world->render();
        }
    const gi::Report& counters = pair.many.renderer->lighting().counters();
    EXPECT_EQ(counters["shadow_map_updates"], 0u);
    EXPECT_GT(counters["shadow_maps_stale"], 30u);
    const Difference difference = compare(pair);
    EXPECT_GT(difference.mean_brightness, 1.0);
    EXPECT_LT(difference.mean, 0.01 * difference.mean_brightness);
}

TEST_F(ManyLightTest, PicturesTooLargeForTheDevicesBuffersAreRefusedByName) {
    constexpr std::uint64_t pixels = 4096 * 4096;
    if (device().traits().max_storage_range >= pixels * sizeof(vec4))
        GTEST_SKIP() << "this device binds buffers that are large enough";
    GpuWorld world(assets::make_cornell, "view");
    gi::Settings settings;
    settings.lights = 8;
    settings.shadow_map_resolution = 32;
    settings.low_resolution = 1;
    world.set(settings);
    world.request.width = world.request.height = 4096;
    const Status refused = world.renderer->render_and_wait(world.request);
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().message.find("raise low_resolution"), std::string::npos) << refused.error().message;
    // And the next frame is drawn.
    settings.low_resolution = 4;
    world.set(settings);
    world.render();
}

} // namespace
} // namespace sunfleck::tests

// The many-light system against brute force: what each optimisation may change of the picture, and what it may not.
#include "gi_module/many_light/many_light_settings.h"
#include "tests/support/gpu_world.h"
#include "tests/support/techniques.h"

#include <random>

namespace sunfleck::tests {
namespace {

class ManyLightTest : public GpuTest {};

// Two renderers of one scene, frame for frame.
struct Pair {
    explicit Pair(void (*make)(assets::SceneBuilder&), const std::string& camera)
        : brute(make, camera), many(make, camera) {}
    void set(const gi::Settings& settings) {
        many.set(settings);
        gi::Settings baseline = gi::Settings().all_light_by("brute_force");
        baseline.lights = settings.lights;
        baseline.seed = settings.seed;
        baseline.shadow_filter = settings.shadow_filter;
        baseline.shadow_map_resolution = settings.shadow_map_resolution;
        baseline.bounces = settings.bounces;
        baseline.candidates = settings.candidates;
        brute.set(baseline);
    }
    void size(std::uint32_t width, std::uint32_t height) {
        for (GpuWorld* world : {&brute, &many}) {
            world->request.width = width;
            world->request.height = height;
        }
    }
    // The many-light system has a past: its maps and lists are from earlier frames. Brute force has none.
    void run_to(std::uint64_t step, float degrees) {
        const scene::CameraView start = many.request.camera;
        for (std::uint64_t k = 0; k <= step; ++k) {
            many.request.step = k;
            many.request.camera = start.orbited(glm::radians(degrees) * float(k));
            many.render();
        }
        brute.request.step = step;
        brute.request.camera = many.request.camera;
        brute.render();
    }
    GpuWorld brute, many;
};

struct Difference {
    double mean = 0, beyond_8 = 0, largest = 0, mean_brightness = 0;
};

Difference compare(Pair& pair) {
    const io::Picture a = pair.many.renderer->read_back().value(), b = pair.brute.renderer->read_back().value();
    Difference result;
    double pixels = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        if (a.pixels[i].a != b.pixels[i].a)
            result.largest = 1e9;
        double largest = 0;
        for (int c = 0; c < 3; ++c) {
            const double d = std::abs(double(a.pixels[i][c]) - double(b.pixels[i][c]));
            largest = std::max(largest, d);
            result.mean += d / 3.0;
            result.mean_brightness += double(b.pixels[i][c]) / 3.0;
        }
        result.largest = std::max(result.largest, largest);
        result.beyond_8 += largest > 8.0 / 255.0;
        pixels += 1;
    }
    result.mean /= pixels;
    result.beyond_8 /= pixels;
    result.mean_brightness /= pixels;
    return result;
}

// Without what approximates (light maps, low resolution, simplified movers, a budget), only the order of sums differs
// from brute force: half a float's rounding of 16-bit output, and 200 float additions. With the database, pairs that it
// has settled skip the map's errors as well (false shadows in corners, light that the bias lets through under walls): a
// few pixels change, and no more than those errors are worth.
TEST_F(ManyLightTest, ExactPartsChangeNothing) {
    for (auto make :
         {assets::make_four_pillars, assets::make_table_room, assets::make_two_rooms, assets::make_near_occluder}) {
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
                    EXPECT_LT(difference.mean, 0.003 * difference.mean_brightness) << "filter " << filter;
                    EXPECT_GT(pair.many.renderer->lighting().counters()["pairs_none"], 10000u);
                }
                EXPECT_GT(difference.mean_brightness, 0.01);
            }
    }
}

// A door that shuts keeps the light out: what was reflected beyond the doorway, too. (Without `mover_paths` samples
// beyond it, made without the door, go on shining.)
TEST_F(ManyLightTest, AClosedDoorKeepsReflectedLightOut) {
    const auto mean_in_dark_room = [](bool mover_paths, std::uint64_t step) {
        GpuWorld world(assets::make_two_rooms, "view");
        gi::Settings settings;
        settings.mover_paths = mover_paths;
        settings.map_budget = 65536;
        world.set(settings);
        world.request.width = 96;
        world.request.height = 72;
        for (const std::uint64_t k : {std::uint64_t(0), step / 2, step}) {
            world.request.step = k;
            world.render();
        }
        const io::Picture picture = world.renderer->read_back().value();
        double sum = 0;
        for (const vec4& pixel : picture.pixels)
            sum += double(pixel.r + pixel.g + pixel.b) / double(picture.pixels.size());
        if (!mover_paths) {
            EXPECT_EQ(world.renderer->lighting().counters()["light_samples_blocked"], 0u);
        } else if (step == 120) {
            EXPECT_GT(world.renderer->lighting().counters()["light_samples_blocked"], 10u);
        }
        return sum;
    };
    const double open = mean_in_dark_room(true, 0), closed = mean_in_dark_room(true, 120);
    const double leaking = mean_in_dark_room(false, 120);
    std::printf("open %.4f, closed %.4f, closed for shadows only %.4f\n", open, closed, leaking);
    EXPECT_GT(open, 0.02);
    // What is left comes round the door: it stands 3 to 5 cm before walls of different thickness.
    EXPECT_LT(closed, 0.05 * open);
    EXPECT_GT(leaking, 5.0 * closed) << "the test must be able to fail";
}

// A lantern is carried about and a lamp changes its strength: samples, database, maps and lists follow, and the picture
// is brute force's of the same samples (which have the same past: both worlds see every step).
TEST_F(ManyLightTest, FollowsLightsThatMoveAndVary) {
    Pair pair(assets::make_four_pillars, "bench_1");
    pair.size(320, 240);
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
    for (std::uint64_t step = 0; step < 24; ++step) {
        w = 0;
        for (GpuWorld* world : {&pair.brute, &pair.many}) {
            const ecs::Entity lamp = lamps[w++];
            const vec3 radiance(step < 8 ? 17.0f : step < 16 ? 6.0f : 0.0f);
            world->renderer->registry().patch<scene::AreaLight>(lamp,
                                                                [&](scene::AreaLight& l) { l.radiance = radiance; });
            world->renderer->registry().patch<scene::Material>(lamp,
                                                               [&](scene::Material& m) { m.emission = radiance; });
            world->request.step = step;
            world->render();
        }
        const gi::Report& counters = pair.many.renderer->lighting().counters();
        EXPECT_EQ(counters["light_samples"], 300u);
        if (step > 8)
            moved = std::max(moved, std::uint64_t(counters["light_samples_moved"]));
        EXPECT_EQ(counters["light_samples_dynamic"] > 0, true);
        if (step % 8 != 7)
            continue;
        const Difference difference = compare(pair);
        std::printf("step %d: mean %.5f of %.3f\n", int(step), difference.mean, difference.mean_brightness);
        EXPECT_LT(difference.mean, 0.006 * difference.mean_brightness);
        EXPECT_GT(difference.mean_brightness, 0.01);
    }
    EXPECT_GE(moved, 1u);
    EXPECT_LT(moved, 30u) << "only the moved light's own samples change";
}

// The whole system at 1024x768, tone-mapped, every map up to date: within 1/255 in the mean, half a per cent of pixels
// off by more than 8/255.
TEST_F(ManyLightTest, TheWholeSystemStaysCloseToBruteForce) {
    struct Case {
        void (*make)(assets::SceneBuilder&);
        const char* camera;
    };
    for (const Case& c : {Case{assets::make_cornell, "bench_1"}, Case{assets::make_area_room, "bench_1"},
                          Case{assets::make_area_room, "bench_2"}, Case{assets::make_table_room, "bench_1"},
                          Case{assets::make_table_room, "bench_2"}, Case{assets::make_four_pillars, "bench_1"},
                          Case{assets::make_four_pillars, "bench_2"}}) {
        Pair pair(c.make, c.camera);
        pair.size(1024, 768);
        for (GpuWorld* world : {&pair.brute, &pair.many}) {
            world->request.view = shared::view_final;
            world->request.tone_map = true;
            world->request.ev100 = viewer::scene_exposure(world->renderer->registry());
        }
        pair.set(gi::Settings());
        pair.run_to(6, 0.25f); // with the usual budget, so that most maps of moving things are some frames old
        const Difference difference = compare(pair);
        std::printf("%s: mean %.3f/255, %.3f%% beyond 8/255\n", c.camera, difference.mean * 255.0,
                    difference.beyond_8 * 100.0);
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

// A block sinks away from its lamp while no map is redrawn: they show it where it was, nearer to the lamp, where it
// would shadow all of its own top.
TEST_F(ManyLightTest, NothingIsShadowedByWhereItWas) {
    const auto make = [](assets::SceneBuilder& s) {
        s.quad("floor", vec3(-4, 0, -4), vec3(0, 0, 8), vec3(8, 0, 0), assets::diffuse(vec3(0.5f)));
        s.ceiling_light("lamp", vec3(0, 3, 0), 0.5f, 0.5f, vec3(50.0f));
        const ecs::Entity block =
            s.box("block", vec3(-0.4f, 0.8f, -0.4f), vec3(0.4f, 1.2f, 0.4f), assets::diffuse(vec3(0.5f)));
        s.mover(block, {});
        s.camera("view", vec3(0.0f, 2.5f, 0.8f), vec3(0.0f, 1.2f, 0.0f), 20.0f);
    };
    Pair pair(make, "view");
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

// A patch in full shadow under a table is as dark as brute force says, though its light map is bright.
TEST_F(ManyLightTest, UmbraStaysDark) {
    const auto make = [](assets::SceneBuilder& s) {
        s.quad("floor", vec3(-4, 0, -4), vec3(0, 0, 8), vec3(8, 0, 0), assets::diffuse(vec3(0.5f)));
        s.ceiling_light("lamp", vec3(0, 3, 0), 0.3f, 0.3f, vec3(50.0f));
        s.quad("table", vec3(-1, 1, -1), vec3(0, 0, 2), vec3(2, 0, 0), assets::diffuse(vec3(0.5f)));
        s.camera("view", vec3(0.0f, 0.6f, 2.0f), vec3(0.0f, 0.0f, 0.2f), 30.0f);
    };
    Pair pair(make, "view");
    pair.size(128, 96);
    gi::Settings settings;
    settings.lights = 64;
    settings.bounces = 0;
    pair.set(settings);
    pair.run_to(2, 0.0f);
    const io::Picture a = pair.many.renderer->read_back().value(), b = pair.brute.renderer->read_back().value();
    int dark = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i)
        if (b.pixels[i].a > 0 && b.pixels[i].r == 0.0f) {
            ++dark;
            EXPECT_LT(a.pixels[i].r, 0.01f); // of about 2 W/m2 beside the table
        }
    EXPECT_GT(dark, 2000);
}

// A flat floor that is shaded as if it were wavy: what light maps know of it is of no use.
TEST_F(ManyLightTest, NormalsOnFlatSurfacesCount) {
    const auto make = [](assets::SceneBuilder& s) {
        const vec3 walls[4] = {vec3(0.6f, 0.1f, 0.1f), vec3(0.1f, 0.6f, 0.1f), vec3(0.6f), vec3(0.6f)};
        s.room(vec3(-3, -0.01f, -3), vec3(3, 3, 3), vec3(0.6f), vec3(0.7f), walls,
               {{"lamp", vec2(-2.0f), 0.5f, 0.5f, vec3(40.0f)}});
        scene::Mesh floor = scene::make_rectangle(6.0f, 6.0f, 24, 24);
        for (std::size_t i = 0; i < floor.normals.size(); ++i) {
            floor.positions[i] = vec3(floor.positions[i].x, 0.0f, -floor.positions[i].y);
            floor.normals[i] = glm::normalize(vec3(0.6f * std::sin(3.0f * floor.positions[i].x), 1.0f, 0.0f));
        }
        s.add("floor", std::move(floor), assets::diffuse(vec3(0.6f)));
        s.camera("view", vec3(0.5f, 2.9f, 0.5f), vec3(0.0f), 60.0f); // of the floor alone
    };
    Pair pair(make, "view");
    pair.size(192, 144);
    gi::Settings settings;
    settings.lights = 100;
    settings.low_resolution = 1;
    settings.bounces = 0; // samples low on the walls would graze the floor, where maps shadow what nothing is above
    pair.set(settings);
    pair.run_to(1, 0.0f);
    const Difference direct = compare(pair);
    settings.bounces = gi::Settings{}.bounces;
    pair.set(settings);
    settings.of<gi::ManyLightSettings>().light_maps = false;
    pair.brute.set(settings);
    pair.run_to(1, 0.0f);
    const Difference all = compare(pair);
    std::printf("%.5f off, of %.4f W/m2 direct; %.5f off, of %.4f W/m2 without light maps\n", direct.mean,
                direct.mean_brightness, all.mean, all.mean_brightness);
    // Normals that do not count would be off by a tenth and more.
    EXPECT_LT(direct.mean, 0.005 * direct.mean_brightness);
    EXPECT_LT(all.mean, 0.005 * all.mean_brightness);
    EXPECT_GT(direct.mean_brightness, 0.1);
}

std::vector<std::int32_t> read_texels(GpuWorld& world, const gi::LightMaps& maps) {
    const std::uint64_t bytes = maps.counters().texels * 16;
    const gpu::Buffer target = read_back(world, maps.texels(), bytes);
    std::vector<std::int32_t> values(std::size_t(bytes) / 4);
    std::memcpy(values.data(), target.mapped(), bytes);
    return values;
}

// Boxes wander through a room for 5,000 changes of place, two million of light maps; large ones hide whole patches from
// samples, so light maps change all the time. At the end they equal maps that know nothing of the past, to the last
// bit.
TEST_F(ManyLightTest, LightMapsNeverDrift) {
    const auto make = [](assets::SceneBuilder& s) {
        const vec3 walls[4] = {vec3(0.6f, 0.1f, 0.1f), vec3(0.1f, 0.6f, 0.1f), vec3(0.6f), vec3(0.6f)};
        s.room(vec3(-3, 0, -3), vec3(3, 3, 3), vec3(0.6f), vec3(0.7f), walls,
               {{"lamp", vec2(0), 1.0f, 1.0f, vec3(20.0f)}});
        for (int i = 0; i < 10; ++i) {
            scene::Transform transform;
            transform.position = vec3(0.0f, 1.0f, 0.0f);
            const ecs::Entity box =
                s.add("box", scene::make_box(vec3(1.6f, 1.6f, 0.2f)), assets::diffuse(vec3(0.5f)), transform);
            s.mover(box, {});
        }
        s.camera("view", vec3(2.5f, 1.5f, 2.5f), vec3(0.0f, 1.0f, 0.0f), 60.0f);
    };
    GpuWorld world(make, "view");
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
    const auto uniform = [&](float low, float high) { return low + (high - low) * float(random() >> 8) * 0x1p-24f; };
    std::uint64_t updates = 0;
    world.render();
    for (int frame = 0; frame < 500; ++frame) {
        for (const ecs::Entity box : boxes)
            world.renderer->registry().patch<scene::Transform>(box, [&](scene::Transform& transform) {
                transform.position = vec3(uniform(-3, 3), uniform(0, 3), uniform(-3, 3));
                transform.rotation = glm::angleAxis(uniform(0, 6), vec3(0, 1, 0));
            });
        world.render();
        updates += world.renderer->lighting().counters()["light_map_updates"];
    }
    std::printf("%llu light map updates\n", static_cast<unsigned long long>(updates));
    EXPECT_GT(updates, 10000u);
    const auto kept = read_texels(world, tests::many_light(world.renderer->lighting()).light_maps());
    // Another seed and back: samples, database and light maps are made anew.
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

// Large patches with fine maps and many samples are many turns of a kernel's loops. Maps interpolate between texels, so
// that pixels differ a little; none may stay dark.
TEST_F(ManyLightTest, LargeLightMapsAreFilledToTheEnd) {
    GpuWorld world(assets::make_near_occluder, "view");
    world.request.width = 96;
    world.request.height = 72;
    gi::Settings settings;
    settings.lights = 600;
    settings.clamp_scale = 8.0f; // small radius, fine texels
    settings.patch_levels = 0;
    settings.shadow_map_resolution = 32;
    settings.low_resolution = 1;
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

TEST_F(ManyLightTest, AnyNumberOfSamplesAndAnyMovers) {
    GpuWorld world(assets::make_two_rooms, "bench_1");
    world.request.width = 48;
    world.request.height = 36;
    std::vector<ecs::Entity> movers;
    world.renderer->registry().view<scene::Mover>().each(
        [&](ecs::Entity entity, const scene::Mover&) { movers.push_back(entity); });
    ASSERT_FALSE(movers.empty());
    for (const std::uint32_t lights : {0u, 1u, 2049u, 65536u}) {
        gi::Settings settings;
        settings.lights = lights;
        world.set(settings);
        for (int frame = 0; frame < 3; ++frame) {
            world.renderer->registry().patch<scene::Transform>(movers[0], [&](scene::Transform& transform) {
                transform.position = frame == 0                 ? vec3(1e4f)
                                     : frame == 1 && lights > 0 ? world.renderer->lighting().samples()[0].position
                                                                : vec3(0.0f);
                transform.scale = vec3(frame == 2 ? 0.0f : 1.0f);
            });
            world.request.step = std::uint64_t(frame);
            const io::Picture picture = world.picture();
            for (const vec4& pixel : picture.pixels)
                ASSERT_TRUE(is_finite(vec3(pixel)) && pixel.r >= 0.0f);
            const gi::Report& counters = world.renderer->lighting().counters();
            EXPECT_EQ(counters["light_samples"], lights);
            EXPECT_EQ(counters["pairs_full"] + counters["pairs_partial"] + counters["pairs_none"] +
                          counters["pairs_unlit"],
                      double(lights) * (counters["surface_patches"] + double(movers.size())));
        }
    }
}

TEST_F(ManyLightTest, ManyObjectsComeAndGo) {
    GpuWorld world(assets::make_four_pillars, "bench_1");
    world.request.width = 48;
    world.request.height = 36;
    gi::Settings settings;
    settings.lights = 40;
    settings.shadow_map_resolution = 32;
    world.set(settings);
    ecs::Registry& registry = world.renderer->registry();
    const std::uint32_t mesh = world.renderer->meshes().add(scene::make_box(vec3(0.1f)));
    ASSERT_TRUE(world.renderer->upload_meshes());
    std::mt19937 random(4);
    const auto uniform = [&](float low, float high) { return low + (high - low) * float(random() >> 8) * 0x1p-24f; };
    std::vector<ecs::Entity> objects;
    for (int i = 0; i < 2000; ++i) {
        const ecs::Entity entity = registry.create();
        scene::Transform transform;
        transform.position = vec3(uniform(-3.9f, 3.9f), uniform(0, 3.4f), uniform(-3.9f, 3.9f));
        registry.emplace<scene::Transform>(entity, transform);
        registry.emplace<scene::MeshInstance>(entity, {mesh});
        registry.emplace<scene::Material>(entity);
        if (i % 4 == 0) // a quarter moves
            registry.emplace<scene::Mover>(entity);
        objects.push_back(entity);
    }
    std::uint64_t memory = 0;
    for (int frame = 0; frame < 30; ++frame) {
        for (int i = 0; i < 10; ++i) {
            const ecs::Entity entity = objects[std::size_t(random() % objects.size()) / 4 * 4];
            if (registry.alive(entity))
                registry.patch<scene::Transform>(entity, [&](scene::Transform& t) { t.position.x = uniform(-5, 5); });
        }
        if (frame == 10)
            for (std::size_t i = 0; i < objects.size(); i += 8)
                registry.destroy(objects[i]);
        world.render();
        const std::uint64_t bytes = device().memory().total();
        if (frame == 15)
            memory = bytes;
        if (frame > 15) {
            EXPECT_LE(bytes, memory);
        }
    }
}

} // namespace
} // namespace sunfleck::tests

// Scenes that change under the many-light system: doors, any number of samples, objects that come and go.
#include "tests/support/test_size.h"
#include "tests/techniques/many_light/many_light.h"

#include <random>

namespace sunfleck::tests {
namespace {

// The lamp is a little brighter from now on: its samples are those of a lamp that varies.
void vary_lamps(ecs::Registry& registry) {
    std::vector<ecs::Entity> lamps;
    registry.view<scene::AreaLight>().each(
        [&](ecs::Entity entity, const scene::AreaLight&) { lamps.push_back(entity); });
    EXPECT_FALSE(lamps.empty());
    for (const ecs::Entity lamp : lamps)
        registry.patch<scene::AreaLight>(lamp, [](scene::AreaLight& light) { light.radiance *= 1.01f; });
}

// Mean of the picture of the room behind the door, when it is at `step`.
double mean_in_dark_room(bool mover_paths, std::uint64_t step, bool lamps_vary = false) {
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
        if (lamps_vary && k == 0) {
            vary_lamps(world.renderer->registry());
            world.render();
        }
    }
    const io::Picture picture = world.renderer->read_back().value();
    double sum = 0;
    for (const vec4& pixel : picture.pixels)
        sum += double(pixel.r + pixel.g + pixel.b) / double(picture.pixels.size());
    if (!mover_paths) {
        EXPECT_EQ(world.renderer->lighting().counters()["light_samples_blocked"], 0u);
    } else if (step == 120) {
        EXPECT_GT(world.renderer->lighting().counters()["light_samples_blocked"], lamps_vary ? 5u : 10u);
    }
    return sum;
}

// A door that shuts keeps the light out: what was reflected beyond the doorway, too. (Without `mover_paths` samples
// beyond it, made without the door, go on shining.)
TEST_F(ManyLightTest, AClosedDoorKeepsReflectedLightOut) {
    const double open = mean_in_dark_room(true, 0), closed = mean_in_dark_room(true, 120);
    const double leaking = mean_in_dark_room(false, 120);
    std::printf("open %.4f, closed %.4f, closed for shadows only %.4f\n", open, closed, leaking);
    EXPECT_GT(open, 0.02);
    // What is left comes round the door: it stands 3 to 5 cm before walls of different thickness.
    EXPECT_LT(closed, 0.05 * open);
    EXPECT_GT(leaking, 5.0 * closed) << "the test must be able to fail";
}

// So it does for a lamp that was ever switched, whose samples follow it.
TEST_F(ManyLightTest, AClosedDoorKeepsReflectedLightOfLampsThatVaryOut) {
    const double open = mean_in_dark_room(true, 0, true), closed = mean_in_dark_room(true, 120, true);
    std::printf("open %.4f, closed %.4f\n", open, closed);
    EXPECT_GT(open, 0.02);
    EXPECT_LT(closed, 0.05 * open);
}

// The largest number takes most of the time, and is left out of the short size.
TEST_F(ManyLightTest, AnyNumberOfSamplesAndAnyMovers) {
    GpuWorld world(assets::make_two_rooms, "bench_1");
    world.request.width = 48;
    world.request.height = 36;
    std::vector<ecs::Entity> movers;
    world.renderer->registry().view<scene::Mover>().each(
        [&](ecs::Entity entity, const scene::Mover&) { movers.push_back(entity); });
    ASSERT_FALSE(movers.empty());
    const std::uint32_t counts[] = {0, 1, by_size(1025u, 2049u), 65536};
    for (const std::uint32_t lights : std::span(counts).first(by_size(3u, 4u))) {
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
            for (const vec4& pixel : world.picture().pixels)
                ASSERT_TRUE(is_finite(vec3(pixel)) && pixel.r >= 0.0f);
            const gi::Report& counters = world.renderer->lighting().counters();
            EXPECT_EQ(counters["light_samples"], lights);
            EXPECT_EQ(counters["pairs_full"] + counters["pairs_partial"] + counters["pairs_none"] +
                          counters["pairs_unlit"],
                      double(lights) * (counters["surface_patches"] + double(movers.size())));
        }
    }
}

float uniform(std::mt19937& random, float low, float high) {
    return low + (high - low) * float(random() >> 8) * 0x1p-24f;
}

// Two thousand, of which a quarter moves.
std::vector<ecs::Entity> add_boxes(ecs::Registry& registry, std::uint32_t mesh, std::mt19937& random) {
    std::vector<ecs::Entity> objects;
    for (int i = 0; i < 2000; ++i) {
        const ecs::Entity entity = registry.create();
        scene::Transform transform;
        transform.position.x = uniform(random, -3.9f, 3.9f);
        transform.position.y = uniform(random, 0, 3.4f);
        transform.position.z = uniform(random, -3.9f, 3.9f);
        registry.emplace<scene::Transform>(entity, transform);
        registry.emplace<scene::MeshInstance>(entity, {mesh});
        registry.emplace<scene::Material>(entity);
        if (i % 4 == 0)
            registry.emplace<scene::Mover>(entity);
        objects.push_back(entity);
    }
    return objects;
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
    const std::vector<ecs::Entity> objects = add_boxes(registry, mesh, random);
    std::uint64_t memory = 0;
    for (int frame = 0; frame < 30; ++frame) {
        for (int i = 0; i < 10; ++i) {
            const ecs::Entity entity = objects[std::size_t(random() % objects.size()) / 4 * 4];
            if (registry.alive(entity))
                registry.patch<scene::Transform>(entity,
                                                 [&](scene::Transform& t) { t.position.x = uniform(random, -5, 5); });
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

// Scenes that change under the many-light system: doors, any number of samples, objects that come and go.
#include "tests/support/brute_force_pair.h"

#include <random>

namespace sunfleck::tests {
namespace {

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
